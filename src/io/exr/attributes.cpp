#include "io/exr/attributes.h"

#include <OpenEXR/ImfBoxAttribute.h>
#include <OpenEXR/ImfDoubleAttribute.h>
#include <OpenEXR/ImfEnvmapAttribute.h>
#include <OpenEXR/ImfFloatAttribute.h>
#include <OpenEXR/ImfIntAttribute.h>
#include <OpenEXR/ImfRationalAttribute.h>
#include <OpenEXR/ImfStringAttribute.h>
#include <OpenEXR/ImfStringVectorAttribute.h>
#include <OpenEXR/ImfTimeCodeAttribute.h>
#include <OpenEXR/ImfVecAttribute.h>
#include <fmt/format.h>
#include <fmt/ranges.h>

namespace polyrecon {
namespace {

template <class T>
const T* value_of(const Imf::Attribute& attribute) {
  const auto* typed = dynamic_cast<const Imf::TypedAttribute<T>*>(&attribute);
  return typed ? &typed->value() : nullptr;
}

}  // namespace

std::string attribute_text(const Imf::Attribute& attribute) {
  if (const auto* text = value_of<std::string>(attribute)) return *text;
  if (const auto* number = value_of<int>(attribute)) return fmt::format("{}", *number);
  if (const auto* number = value_of<float>(attribute)) return fmt::format("{}", *number);
  if (const auto* number = value_of<double>(attribute)) return fmt::format("{}", *number);
  if (const auto* ratio = value_of<Imf::Rational>(attribute)) return fmt::format("{}/{}", ratio->n, ratio->d);
  if (const auto* v = value_of<Imath::V2f>(attribute)) return fmt::format("{} {}", v->x, v->y);
  if (const auto* v = value_of<Imath::V2i>(attribute)) return fmt::format("{} {}", v->x, v->y);
  if (const auto* v = value_of<Imath::V3f>(attribute)) return fmt::format("{} {} {}", v->x, v->y, v->z);
  if (const auto* b = value_of<Imath::Box2i>(attribute))
    return fmt::format("{} {} {} {}", b->min.x, b->min.y, b->max.x, b->max.y);
  if (const auto* map = value_of<Imf::Envmap>(attribute)) return *map == Imf::ENVMAP_LATLONG ? "latlong" : "cube";
  if (const auto* list = value_of<Imf::StringVector>(attribute)) return fmt::format("{}", fmt::join(*list, ", "));
  return {};
}

void set_attribute(Imf::Header& header, const std::string& name, const Imf::Attribute& value) {
  header.erase(name);
  header.insert(name, value);
}

}  // namespace polyrecon
