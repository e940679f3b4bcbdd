#include "cli/app.h"

#include <string>

namespace polyrecon {

void setup_app(CLI::App& app, Command& chosen) {
  app.name("polyrecon");
  app.description("Denoises Monte Carlo renders by adaptive polynomial reconstruction.");
  const std::string version = "polyrecon " POLYRECON_VERSION;
  app.set_version_flag("-v,-V,--version", version);
  app.add_flag(check_options,
               "Check the options of the command that follows, and do nothing else: 0, or 2 with the mistake");
  app.require_subcommand(1);
  app.fallthrough(false);
  app.footer(
      "Exit codes:\n"
      "  0         done\n"
      "  1         internal error\n"
      "  2         wrong use: unknown option, contradiction, value out of range\n"
      "  3         bad input: damaged, incomplete or unsupported file\n"
      "  4         a file, frame or pass is missing\n"
      "  5         the output could not be written\n"
      "  6         the result failed its own check\n"
      "  7         the renderer failed\n"
      "  8         --time-budget or --target was missed, with --on-miss fail\n"
      "  33        not enough memory\n"
      "  130, 143  interrupted, terminated\n"
      "Examples:\n"
      "  polyrecon render.exr\n"
      "  polyrecon denoise -i render.exr -o clean.exr\n"
      "  polyrecon inspect render.exr\n"
      "  polyrecon merge part*.exr -o merged.exr\n"
      "A file, a folder or a sequence in place of a command is denoised; the result is next to it.\n"
      "polyrecon help COMMAND describes a command.");
  setup_denoise(app, chosen);
  setup_inspect(app, chosen);
  setup_merge(app, chosen);
  setup_samplemap(app, chosen);
  setup_preview(app, chosen);
  setup_view(app, chosen);
  setup_compare(app, chosen);
  setup_sweep(app, chosen);
  for (CLI::App* sub : app.get_subcommands(nullptr)) sub->set_version_flag("--version", version);
}

}  // namespace polyrecon
