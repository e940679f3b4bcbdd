// The C interface of libpolyrecon: denoises Monte Carlo renders that are in memory or in EXR files.
//
// A filter does one kind of work. Set its images and parameters, execute it, and take the images that it made:
//
//     polyrecon_filter* filter = polyrecon_new_filter("denoise");
//     polyrecon_image beauty = {pixels, POLYRECON_FLOAT, 1920, 1080, 3, 0, 0, 0};
//     polyrecon_set_image(filter, "beauty", &beauty);
//     if (polyrecon_execute(filter) == POLYRECON_OK) polyrecon_get_image(filter, "result", &beauty);
//     polyrecon_release_filter(filter);
//
// docs/guide/library.md lists the kinds of filters, their images and their parameters.
//
// Several threads may use different filters at the same time; a filter belongs to one thread at a time. No function
// prints anything, ends the process, or lets an exception out. A result has the same bits as that of the program
// `polyrecon` on the same machine, whatever the number of threads. Functions and constants that are here stay as they
// are in all libraries with the name libpolyrecon.so.1.
#pragma once

#include <stddef.h>  // NOLINT(modernize-deprecated-headers): this header is C

#ifdef __cplusplus
extern "C" {
#endif

#if defined(__GNUC__)
#define POLYRECON_API __attribute__((visibility("default")))
#else
#define POLYRECON_API
#endif

// NOLINTBEGIN(modernize-use-using,readability-identifier-naming): names of C

/// The outcome of a call. The values are the program's exit codes.
typedef enum polyrecon_error {
  POLYRECON_OK = 0,
  POLYRECON_INTERNAL = 1,      ///< A fault of the library.
  POLYRECON_USAGE = 2,         ///< An unknown name, a value out of range, or a contradiction.
  POLYRECON_BAD_INPUT = 3,     ///< An input is damaged, or does not fit the others.
  POLYRECON_MISSING = 4,       ///< A file, layer, image or library does not exist.
  POLYRECON_CANNOT_WRITE = 5,  ///< A file cannot be written; an older one stays as it was.
  POLYRECON_CHECK_FAILED = 6,  ///< The result failed a check and is not given out.
  POLYRECON_OUT_OF_MEMORY = 33,
  POLYRECON_INTERRUPTED = 130  ///< The progress function asked to stop.
} polyrecon_error;

/// The type of the samples of an image.
typedef enum polyrecon_format {
  POLYRECON_FLOAT = 1,  ///< 32 bits.
  POLYRECON_HALF = 2    ///< 16 bits, as in OpenEXR.
} polyrecon_format;

/// An image in the caller's memory. Strides are distances in bytes and may be negative. Where all three are 0 there is
/// no padding: R G B R G B ... from the upper left pixel to the right and then down.
typedef struct polyrecon_image {
  void* data;  ///< The first channel of the upper left pixel. It is not written to by polyrecon_set_image.
  polyrecon_format format;
  int width, height, channels;
  ptrdiff_t channel_stride;  ///< From a channel to the next.
  ptrdiff_t pixel_stride;    ///< From a pixel to the one on its right.
  ptrdiff_t row_stride;      ///< From a pixel to the one below.
} polyrecon_image;

/// A piece of work with its images, parameters and results.
typedef struct polyrecon_filter polyrecon_filter;

/// Receives the progress: `done`, 0 to 1, of the phase of this name. Returns 1 to go on, 0 to stop. It is called from
/// any thread, by one at a time, about twenty times a second, and must not call functions of this header with the same
/// filter.
typedef int (*polyrecon_progress)(void* user, const char* phase, double done);

/// The version of the library: "0.1.0".
POLYRECON_API const char* polyrecon_version(void);

/// Makes a filter of a kind: "denoise", "sample map", "read", "write" or "merge". Null for another name, and where
/// there is no memory.
POLYRECON_API polyrecon_filter* polyrecon_new_filter(const char* kind);

/// Frees a filter and its images; null is allowed.
POLYRECON_API void polyrecon_release_filter(polyrecon_filter* filter);

/// The error of the last function that was called with this filter, and its message of one line: what happened, to
/// which image, file or parameter, and what to do. message: may be null; valid until the next call with the filter, and
/// empty where nothing happened.
POLYRECON_API polyrecon_error polyrecon_get_error(const polyrecon_filter* filter, const char** message);

/// Gives the filter an input image. Nothing is copied: the samples are read by polyrecon_execute and must stay in place
/// until it returns. image: null, or with null data, takes the input away.
POLYRECON_API polyrecon_error polyrecon_set_image(polyrecon_filter* filter, const char* name,
                                                  const polyrecon_image* image);

/// Sets a parameter that is a text. A parameter that takes several texts, such as the files of "merge", gets one more.
/// value: null sets the parameter back to its default.
POLYRECON_API polyrecon_error polyrecon_set_text(polyrecon_filter* filter, const char* name, const char* value);

/// Sets a parameter that is a number; switches are 0 or 1.
POLYRECON_API polyrecon_error polyrecon_set_number(polyrecon_filter* filter, const char* name, double value);

/// Sets the function that receives the progress of polyrecon_execute and may stop it; null for none.
POLYRECON_API polyrecon_error polyrecon_set_progress(polyrecon_filter* filter, polyrecon_progress progress, void* user);

/// Does the work. May be called again, with other images or parameters too; the results before are dropped.
POLYRECON_API polyrecon_error polyrecon_execute(polyrecon_filter* filter);

/// The number of images that the last polyrecon_execute made, and the name of each; null beyond the last.
POLYRECON_API int polyrecon_image_count(const polyrecon_filter* filter);
POLYRECON_API const char* polyrecon_image_name(const polyrecon_filter* filter, int index);

/// Describes an image that was made: sets width, height and channels of *image and nothing else.
POLYRECON_API polyrecon_error polyrecon_describe_image(polyrecon_filter* filter, const char* name,
                                                       polyrecon_image* image);

/// Copies an image that was made to the memory that *target describes, which must have its size. Half samples saturate
/// at 65504.
POLYRECON_API polyrecon_error polyrecon_get_image(polyrecon_filter* filter, const char* name,
                                                  const polyrecon_image* target);

/// The report of the last polyrecon_execute, as JSON (docs/reference/report.md); empty before it. Valid until the next
/// call with the filter.
POLYRECON_API const char* polyrecon_get_report(const polyrecon_filter* filter);

// NOLINTEND(modernize-use-using,readability-identifier-naming)

#ifdef __cplusplus
}
#endif
