#pragma once

#include <string>

#include "polyrecon/image.h"

namespace polyrecon {

/// How a page stores samples.
enum class PageSamples { Half, Float };

/// Whether halves hold the values to half precision: none is finite and beyond the range of halves.
bool fit_into_halves(const Image& image);

/// All planes as base64 of zlib's format. A plane holds the differences of successive bit patterns, modulo 2^16 or
/// 2^32, as bytes: first the highest one of every sample, then the next lower one of every sample; so they pack better.
/// viewer/scene.js unpacks them. Throws Error{OutOfMemory} where zlib has too little memory.
std::string packed_samples(const Image& image, PageSamples samples);

/// These bytes in base64.
std::string base64(const std::string& bytes);

}  // namespace polyrecon
