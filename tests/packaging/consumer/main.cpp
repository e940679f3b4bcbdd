// Denoises a frame with the three calls of the library, read, reconstruct and write: consumer IN.exr OUT.exr

#include <cstdio>
#include <exception>

#include "polyrecon/progress.h"
#include "polyrecon/read_frame.h"
#include "polyrecon/reconstruct.h"
#include "polyrecon/write_result.h"

int main(int argc, char** argv) {
  if (argc != 3) return 2;
  try {
    polyrecon::ReadResult in = polyrecon::read_frame(argv[1]);
    const polyrecon::Result result = polyrecon::reconstruct(
        in.frame, polyrecon::params_for(polyrecon::Quality::Standard), polyrecon::silent_progress());
    polyrecon::write_result(in.source, {{in.frame.beauty.name, result.beauty, false}}, argv[2], {});
    return 0;
  } catch (const std::exception& e) {
    std::fprintf(stderr, "consumer: %s\n", e.what());
    return 1;
  }
}
