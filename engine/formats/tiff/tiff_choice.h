#pragma once
// The choices in a TIFF that holds more than one volume, and the user's choice. Any thread may call these functions.

#include "engine/formats/tiff/tiff_description.h"
#include "engine/formats/tiff/tiff_samples.h"
#include "engine/volume/source.h"

namespace shvr {

/// A volume that each page's pixels can hold: one of their samples, or one colour of the palette.
struct TiffPixelChannel {
    std::string name{};  ///< "" if the channel has only a number
    int sample = 0;
    int palette_color = -1;
    bool is_usual = false;  ///< the default if no channel is chosen
};

/// Returns at least one. May add to `warnings`. A palette whose entry numbers are the intensities offers no choice.
std::vector<TiffPixelChannel> channels_of_pixel(const TiffPage& page, const TiffLayout& layout,
                                                const TiffDescription& description, std::vector<std::string>& warnings);

/// Returns `options`, with the usual one of `channels`, and a warning, if no channel is chosen and a usual one exists.
OpenOptions with_usual_channel(const OpenOptions& options, const std::vector<TiffPixelChannel>& channels,
                               std::vector<std::string>& warnings);

struct TiffChoice {
    size_t channel = 0;  ///< index into `names`
    int64_t frame = 0;   ///< from 0
};

/// The choice that takes all channels, or all time points, as the slices of one volume.
inline constexpr const char* AS_SLICES = "slices";
/// Fails, listing the choices, if there are several and none is chosen, or if the chosen one does not exist.
/// `may_be_slices`: whether AS_SLICES is one of the choices; the caller applies it.
TiffChoice choose(const std::string& subject, const OpenOptions& options, const std::vector<std::string>& names,
                  int64_t frames, bool may_be_slices = false);

}  // namespace shvr
