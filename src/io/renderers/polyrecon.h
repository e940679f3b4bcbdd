#pragma once

namespace polyrecon {

// The names that this program itself gives to what it writes.
constexpr const char* noisy_suffix = " Noisy";        ///< A layer that is kept as it was (WriteOptions::keep_noisy).
constexpr const char* error_suffix = " Error";        ///< Estimated relative MSE of a layer of a result.
constexpr const char* order_suffix = " Order";        ///< Its polynomial order.
constexpr const char* variance_suffix = " Variance";  ///< The companions that `merge` writes.
constexpr const char* half_a_suffix = " A";
constexpr const char* half_b_suffix = " B";
constexpr const char* sample_count_pass = "Sample Count";
constexpr const char* shared_samples_attribute = "polyrecon/sharedSamples";  ///< Note of `merge` about them.
constexpr const char* samples_attribute = "polyrecon/{}/samples";            ///< "{}" stands for the view layer.
constexpr const char* version_attribute = "polyrecon/version";
constexpr const char* input_attribute = "polyrecon/input";            ///< Identity of the file that was denoised.
constexpr const char* error_attribute = "polyrecon/estimatedRelMSE";  ///< Mean over the picture of a result.
constexpr const char* settings_attribute = "polyrecon/settings";      ///< Settings of a result of `denoise`.

}  // namespace polyrecon
