#pragma once

namespace polyrecon {

/// Channels of the colour images that the pipeline works on (HalfPair::color, Candidate::half), one after another:
///     R G B of the beauty | R G B of each AOV | alpha, where it is reconstructed
/// Beauty and AOVs are the layers of the image: layer 0 is the beauty. What is decided on the beauty's red, green or
/// blue is applied to the same primary of every layer, so that layers that add up to the beauty still do.
class ColorLayout {
 public:
  static constexpr int primaries = 3;  ///< Channels of a layer.

  ColorLayout(int aovs, bool alpha) : layers_(1 + aovs), alpha_(alpha) {}
  /// The layout of an image of so many channels.
  explicit ColorLayout(int channels) : layers_(channels / primaries), alpha_(channels % primaries != 0) {}

  int layers() const { return layers_; }
  bool has_alpha() const { return alpha_; }
  int channels() const { return alpha_channel() + (alpha_ ? 1 : 0); }
  /// Channels of the layers, that is all but alpha. They come first.
  int layer_channels() const { return primaries * layers_; }
  /// First channel of a layer.
  static int first_channel(int layer) { return primaries * layer; }
  /// Channel of a primary (0 to 2) of a layer.
  static int channel(int layer, int primary) { return first_channel(layer) + primary; }
  /// The channel of the beauty that has the primary of a layer's channel.
  static int beauty_channel(int channel) { return channel % primaries; }
  int alpha_channel() const { return layer_channels(); }

 private:
  int layers_;
  bool alpha_;
};

}  // namespace polyrecon
