/* Denoises images in memory with libpolyrecon: denoise IN.exr OUT.exr
 *
 *     cc denoise.c -o denoise $(pkg-config --cflags --libs polyrecon)
 *
 * Here the images come from a file; a renderer passes its own buffers to polyrecon_set_image. */

#include <polyrecon/polyrecon.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { most_images = 64 };

/* Ends this program where a call failed. The library itself never does. */
static void check(const polyrecon_filter* filter) {
  const char* message;
  const polyrecon_error error = polyrecon_get_error(filter, &message);
  if (error == POLYRECON_OK) return;
  fprintf(stderr, "denoise: %s\n", message);
  exit(error);
}

static polyrecon_filter* new_filter(const char* kind) {
  polyrecon_filter* filter = polyrecon_new_filter(kind);
  if (!filter) exit(1);
  return filter;
}

/* An image that a filter made, as R G B R G B ... in memory of our own. */
static polyrecon_image take(polyrecon_filter* filter, const char* name) {
  polyrecon_image image;
  memset(&image, 0, sizeof image); /* strides of 0: no padding */
  image.format = POLYRECON_FLOAT;
  polyrecon_describe_image(filter, name, &image);
  check(filter);
  image.data = malloc((size_t)image.width * (size_t)image.height * (size_t)image.channels * sizeof(float));
  if (!image.data) exit(1);
  polyrecon_get_image(filter, name, &image);
  check(filter);
  return image;
}

static int print_progress(void* user, const char* phase, double done) {
  (void)user;
  printf("\r%-24s %3.0f %%", phase, 100 * done);
  return 1; /* 0 would stop the work */
}

int main(int argc, char** argv) {
  polyrecon_filter *read, *denoise, *write;
  polyrecon_image images[most_images], result;
  int i, count;
  if (argc != 3) {
    fprintf(stderr, "usage: denoise IN.exr OUT.exr\n");
    return 2;
  }

  read = new_filter("read");
  polyrecon_set_text(read, "input", argv[1]);
  polyrecon_execute(read);
  check(read);

  denoise = new_filter("denoise");
  count = polyrecon_image_count(read);
  for (i = 0; i < count && i < most_images; ++i) {
    images[i] = take(read, polyrecon_image_name(read, i));
    polyrecon_set_image(denoise, polyrecon_image_name(read, i), &images[i]);
    check(denoise);
  }
  polyrecon_set_text(denoise, "quality", "standard");
  polyrecon_set_progress(denoise, print_progress, NULL);
  polyrecon_execute(denoise);
  printf("\n");
  check(denoise);
  result = take(denoise, "result");

  write = new_filter("write");
  polyrecon_set_text(write, "like", argv[1]);
  polyrecon_set_text(write, "output", argv[2]);
  polyrecon_set_image(write, "result", &result);
  polyrecon_execute(write);
  check(write);

  for (i = 0; i < count && i < most_images; ++i) free(images[i].data);
  free(result.data);
  polyrecon_release_filter(read);
  polyrecon_release_filter(denoise);
  polyrecon_release_filter(write);
  return 0;
}
