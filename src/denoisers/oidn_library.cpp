#include "denoisers/oidn_library.h"

#include <dlfcn.h>
#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <limits>
#include <map>
#include <system_error>

#include "core/color_layout.h"
#include "core/parallel.h"
#include "polyrecon/error.h"

namespace polyrecon {
namespace {

namespace fs = std::filesystem;

constexpr const char* library_file = "libOpenImageDenoise.so.2";

// The part of the C interface that is used, as its reference documents it (oidn.h of version 2; the values of its
// enumerations do not change within a major version).
using Handle = void*;  // of a device, a filter or a buffer
enum DeviceType : int { AnyDevice = 0, CpuDevice = 1, SyclDevice = 2, CudaDevice = 3, HipDevice = 4, MetalDevice = 5 };
constexpr int format_float3 = 3;
constexpr int quality_high = 6;
constexpr int no_error = 0, cancelled_error = 6;

struct Functions {
  Handle (*new_device)(int type);
  void (*release_device)(Handle);
  void (*set_device_int)(Handle, const char* name, int);
  void (*set_device_bool)(Handle, const char* name, bool);
  int (*device_int)(Handle, const char* name);
  void (*commit_device)(Handle);
  int (*device_error)(Handle, const char** message);
  Handle (*new_buffer)(Handle device, std::size_t bytes);
  void (*write_buffer)(Handle, std::size_t offset, std::size_t bytes, const void* from);
  void (*read_buffer)(Handle, std::size_t offset, std::size_t bytes, void* to);
  void (*release_buffer)(Handle);
  Handle (*new_filter)(Handle device, const char* type);
  void (*set_image)(Handle, const char* name, Handle buffer, int format, std::size_t width, std::size_t height,
                    std::size_t offset, std::size_t pixel_stride, std::size_t row_stride);
  void (*set_filter_bool)(Handle, const char* name, bool);
  void (*set_filter_int)(Handle, const char* name, int);
  void (*set_monitor)(Handle, bool (*monitor)(void* user, double done), void* user);
  void (*commit_filter)(Handle);
  void (*execute_filter)(Handle);
  void (*release_filter)(Handle);
};

template <typename Function>
bool load(void* library, const char* name, Function& function) {
  function = reinterpret_cast<Function>(::dlsym(library, name));
  return function != nullptr;
}

bool load(void* library, Functions& f) {
  return load(library, "oidnNewDevice", f.new_device) && load(library, "oidnReleaseDevice", f.release_device) &&
         load(library, "oidnSetDeviceInt", f.set_device_int) && load(library, "oidnSetDeviceBool", f.set_device_bool) &&
         load(library, "oidnGetDeviceInt", f.device_int) && load(library, "oidnCommitDevice", f.commit_device) &&
         load(library, "oidnGetDeviceError", f.device_error) && load(library, "oidnNewBuffer", f.new_buffer) &&
         load(library, "oidnWriteBuffer", f.write_buffer) && load(library, "oidnReadBuffer", f.read_buffer) &&
         load(library, "oidnReleaseBuffer", f.release_buffer) && load(library, "oidnNewFilter", f.new_filter) &&
         load(library, "oidnSetFilterImage", f.set_image) && load(library, "oidnSetFilterBool", f.set_filter_bool) &&
         load(library, "oidnSetFilterInt", f.set_filter_int) &&
         load(library, "oidnSetFilterProgressMonitorFunction", f.set_monitor) &&
         load(library, "oidnCommitFilter", f.commit_filter) && load(library, "oidnExecuteFilter", f.execute_filter) &&
         load(library, "oidnReleaseFilter", f.release_filter);
}

const std::map<std::string, int>& device_types() {
  static const std::map<std::string, int> types{{"auto", AnyDevice}, {"cpu", CpuDevice},   {"cuda", CudaDevice},
                                                {"hip", HipDevice},  {"sycl", SyclDevice}, {"metal", MetalDevice}};
  return types;
}

/// The value of an environment variable; empty where it is not set.
std::string text_of(const char* value) { return value ? value : ""; }

/// The folders of a list such as that in PATH.
std::vector<fs::path> folders_in(const char* list) {
  std::vector<fs::path> folders;
  const std::string path = text_of(list);
  for (std::size_t begin = 0; begin < path.size();) {
    const std::size_t end = std::min(path.find(':', begin), path.size());
    folders.emplace_back(path.substr(begin, end - begin));
    begin = end + 1;
  }
  return folders;
}

/// Folders of the modules of every Python below `prefix`.
std::vector<fs::path> python_modules(const fs::path& prefix) {
  std::vector<fs::path> found;
  std::error_code ignored;
  for (const auto& entry : fs::directory_iterator(prefix / "lib", ignored))
    if (entry.path().filename().string().rfind("python3", 0) == 0)
      for (const char* name : {"site-packages", "dist-packages"}) found.push_back(entry.path() / name);
  std::sort(found.rbegin(), found.rend());
  return found;
}

/// The folder of Python modules that this program or library is installed in (polyrecon/bin/, polyrecon/lib/); empty if
/// its own path is not known.
fs::path own_modules() {
  Dl_info binary{};
  std::error_code ignored;
  if (::dladdr(reinterpret_cast<const void*>(&own_modules), &binary) == 0 || !binary.dli_fname) return {};
  const fs::path path = binary.dli_fname;  // of a program the first word of its command line
  return path.is_absolute() ? fs::canonical(path, ignored).parent_path().parent_path().parent_path() : fs::path();
}

/// Folders of Python modules: that of this binary, of the active environment, of each Python on the PATH, and of the
/// user.
std::vector<fs::path> python_modules() {
  std::vector<fs::path> prefixes;
  std::error_code ignored;
  if (const std::string active = text_of(std::getenv("VIRTUAL_ENV")); !active.empty()) prefixes.emplace_back(active);
  for (const fs::path& folder : folders_in(std::getenv("PATH")))
    if (fs::exists(folder / "python3", ignored)) prefixes.push_back(folder.parent_path());
  if (const std::string home = text_of(std::getenv("HOME")); !home.empty())
    prefixes.push_back(fs::path(home) / ".local");
  std::vector<fs::path> modules;
  if (fs::path folder = own_modules(); !folder.empty()) modules.push_back(std::move(folder));
  for (const fs::path& prefix : prefixes)
    for (const fs::path& folder : python_modules(prefix))
      if (std::find(modules.begin(), modules.end(), folder) == modules.end()) modules.push_back(folder);
  return modules;
}

/// What the user has named: the value of --oidn, else $POLYRECON_OIDN.
std::string named_library(const std::string& option) {
  return option.empty() ? text_of(std::getenv("POLYRECON_OIDN")) : option;
}

/// The file that --oidn or $POLYRECON_OIDN means.
std::string file_of(const std::string& path) {
  std::error_code ignored;
  return fs::is_directory(path, ignored) ? (fs::path(path) / library_file).string() : path;
}

/// The file that a symbol of the library was loaded from.
std::string path_of(void* symbol, const std::string& requested) {
  Dl_info info{};
  return ::dladdr(symbol, &info) != 0 && info.dli_fname ? info.dli_fname : requested;
}

std::vector<float> packed(const Image& image) {
  std::vector<float> out(image.pixels() * ColorLayout::primaries);
  for (int c = 0; c < ColorLayout::primaries; ++c)
    for (std::size_t i = 0; i < image.pixels(); ++i)
      out[i * ColorLayout::primaries + static_cast<std::size_t>(c)] = static_cast<float>(image.plane(c)[i]);
  return out;
}

Image unpacked(const std::vector<float>& values, int width, int height) {
  Image out(width, height, ColorLayout::primaries);
  for (int c = 0; c < ColorLayout::primaries; ++c)
    for (std::size_t i = 0; i < out.pixels(); ++i)
      out.plane(c)[i] = static_cast<Real>(values[i * ColorLayout::primaries + static_cast<std::size_t>(c)]);
  return out;
}

/// The data of the library's callback, which must not throw through the library.
struct Monitor {
  const std::function<bool(double)>& advance;
  double done = 0;

  static bool call(void* user, double done) {
    auto& self = *static_cast<Monitor*>(user);
    const double more = std::max(0.0, done - self.done);
    self.done += more;
    return self.advance(more);
  }
};

using Owned = std::unique_ptr<void, void (*)(Handle)>;

}  // namespace

struct OidnLibrary::Loaded {
  std::string path;
  Functions call{};
  Owned device{nullptr, nullptr};

  /// Loads the library and makes a device. Returns the reason where that is not possible, else nothing.
  std::string open(const std::string& file, int type) {
    // The system's loader would wait for a pipe.
    if (std::error_code ignored; fs::is_other(fs::status(file, ignored))) return file + " is not a file";
    void* library = ::dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL);  // stays loaded: its threads may still be running
    if (!library) return ::dlerror();
    if (!load(library, call)) return file + " is no Open Image Denoise of version 2";
    path = path_of(reinterpret_cast<void*>(call.new_device), file);
    device = Owned(call.new_device(type), call.release_device);
    if (!device) return error_text(nullptr);
    call.set_device_int(device.get(), "numThreads", threads());
    call.set_device_bool(device.get(), "setAffinity", false);  // the fits run on the same processors
    call.commit_device(device.get());
    return error_text(device.get());
  }

  /// The error since the last call; empty if there was none.
  std::string error_text(Handle of) const {
    const char* message = nullptr;
    if (call.device_error(of, &message) == no_error) return of ? "" : "no such device";
    return message ? message : "unknown error";
  }
};

std::vector<std::string> oidn_devices() {
  std::vector<std::string> names;
  for (const auto& [name, type] : device_types()) names.push_back(name);
  return names;
}

std::vector<std::string> oidn_places() {
  std::vector<std::string> places{library_file};
  std::error_code ignored;
  const auto add = [&](const fs::path& file) {
    if (fs::exists(file, ignored)) places.push_back(file.string());
  };
  for (const fs::path& folder : folders_in(std::getenv("PATH")))
    if (const fs::path blender = fs::canonical(folder / "blender", ignored); !blender.empty())
      add(blender.parent_path() / "lib" / library_file);
  const std::vector<fs::path> modules = python_modules();
  for (const fs::path& folder : modules) add(folder / "bpy" / "lib" / library_file);
  for (const fs::path& folder : modules) add(folder / "pyoidn" / "oidn" / "lib" / library_file);
  return places;
}

bool oidn_is_installed(const std::string& path) {
  std::error_code ignored;
  if (const std::string named = named_library(path); !named.empty()) return fs::exists(file_of(named), ignored);
  std::vector<fs::path> folders = folders_in(std::getenv("LD_LIBRARY_PATH"));
  for (const char* folder : {"/usr/lib/x86_64-linux-gnu", "/usr/lib64", "/usr/lib", "/usr/local/lib", "/lib64"})
    folders.emplace_back(folder);
  return oidn_places().size() > 1 || std::any_of(folders.begin(), folders.end(), [&](const fs::path& folder) {
           return fs::exists(folder / library_file, ignored);
         });
}

OidnLibrary::OidnLibrary(const OidnOptions& options) {
  const int type = device_types().at(options.device);
  const std::string named = named_library(options.path);
  const std::string source = options.path.empty() ? "$POLYRECON_OIDN" : "--oidn";
  std::string reason;
  for (const std::string& file : named.empty() ? oidn_places() : std::vector<std::string>{file_of(named)}) {
    auto loaded = std::make_unique<Loaded>();
    const std::string problem = loaded->open(file, type);
    if (problem.empty()) {
      loaded_ = std::move(loaded);
      return;
    }
    // The system's library is the only place that may not exist: its absence explains nothing.
    if (reason.empty() || file != library_file) reason = loaded->path.empty() ? problem : loaded->path + ": " + problem;
  }
  if (!named.empty())
    throw Error(ExitCode::Missing, fmt::format("{}: Open Image Denoise cannot be used ({})", source, reason));
  throw Error(
      ExitCode::Missing,
      fmt::format(
          "Open Image Denoise cannot be used ({}): install the system's package, put Blender 4.1 or later on the PATH "
          "or run 'pip install pyoidn', or name its library with --oidn",
          reason));
}

OidnLibrary::~OidnLibrary() = default;

std::string OidnLibrary::path() const { return loaded_->path; }

std::string OidnLibrary::version() const {
  const auto number = [&](const char* name) { return loaded_->call.device_int(loaded_->device.get(), name); };
  return fmt::format("{}.{}.{}", number("versionMajor"), number("versionMinor"), number("versionPatch"));
}

std::string OidnLibrary::device() const {
  const int type = loaded_->call.device_int(loaded_->device.get(), "type");
  for (const auto& [name, value] : device_types())
    if (value == type) return name;
  return "unknown";
}

Image OidnLibrary::filter(const OidnImages& images, std::size_t max_bytes,
                          const std::function<bool(double)>& advance) const {
  const Functions& call = loaded_->call;
  Handle device = loaded_->device.get();
  const Image& shape = images.shape();
  const auto width = static_cast<std::size_t>(shape.width()), height = static_cast<std::size_t>(shape.height());
  const std::size_t bytes = shape.pixels() * ColorLayout::primaries * sizeof(float);
  std::vector<Owned> buffers;
  const Owned filter(call.new_filter(device, "RT"), call.release_filter);
  const auto check = [&] {
    const char* message = nullptr;
    const int code = call.device_error(device, &message);
    if (code == cancelled_error) throw Error(ExitCode::Interrupted, "interrupted");
    if (code != no_error)
      throw Error(ExitCode::Missing, fmt::format("{}: {}", loaded_->path, message ? message : "the filter failed"));
  };
  check();
  const auto set_image = [&](const char* name, const Image* image) {
    if (!image && std::string(name) != "output") return;
    buffers.emplace_back(call.new_buffer(device, bytes), call.release_buffer);
    check();
    if (image) call.write_buffer(buffers.back().get(), 0, bytes, packed(*image).data());
    call.set_image(filter.get(), name, buffers.back().get(), format_float3, width, height, 0, 0, 0);
  };
  set_image("color", images.color);
  set_image("albedo", images.albedo);
  set_image("normal", images.normal);
  set_image("output", nullptr);
  Monitor monitor{advance};
  const std::size_t megabytes = std::min<std::size_t>(max_bytes >> 20u, std::numeric_limits<int>::max());
  call.set_filter_bool(filter.get(), "hdr", images.color != nullptr);
  call.set_filter_bool(filter.get(), "cleanAux", images.color != nullptr);
  call.set_filter_int(filter.get(), "quality", quality_high);
  call.set_filter_int(filter.get(), "maxMemoryMB", static_cast<int>(megabytes));
  call.set_monitor(filter.get(), Monitor::call, &monitor);
  call.commit_filter(filter.get());
  check();
  call.execute_filter(filter.get());
  check();
  Monitor::call(&monitor, 1);
  std::vector<float> values(shape.pixels() * ColorLayout::primaries);
  call.read_buffer(buffers.back().get(), 0, bytes, values.data());
  check();
  return unpacked(values, shape.width(), shape.height());
}

}  // namespace polyrecon
