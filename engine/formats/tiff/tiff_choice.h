#pragma once
// The choices in a TIFF that holds more than one volume, and the user's choice. Any thread may call these functions.

#include "engine/formats/tiff/tiff_description.h"
#include "engine/formats/tiff/tiff_samples.h"
#include "engine/volume/source.h"

namespace shvr {

/// One of the volumes that the pixels of the pages can hold: one sample of each pixel, or one palette colour.
struct TiffPixelChannel {
    std::string name{};  ///< "" if the channel has only a number
    int sample = 0;
    int palette_color = -1;
    bool is_usual = false;  ///< the default if no channel is chosen
};

/// Returns at least one. May add to `warnings`. A palette whose entry numbers are the intensities offers no choice.
std::vector<TiffPixelChannel> channels_of_pixel(const TiffPage& page, const TiffLayout& layout,
                                                const TiffDescription& description, std::vector<std::string>& warnings);

/// Returns `options`. If no channel is chosen and `channels` has a usual one, chooses that one and adds a warning.
OpenOptions with_usual_channel(const OpenOptions& options, const std::vector<TiffPixelChannel>& channels,
                               std::vector<std::string>& warnings);

struct TiffChoice {
    size_t channel = 0;  ///< index into `names`
    int64_t frame = 0;   ///< from 0
};

/// The value of a choice that makes all channels, or all time points, the slices of one volume.
inline constexpr const char* AS_SLICES = "slices";
/// Returns the choice. Fails, listing the choices, if several exist and none is chosen, or the chosen one is missing.
/// `may_be_slices`: whether AS_SLICES is one of the choices; the caller applies it.
TiffChoice choose(const std::string& subject, const OpenOptions& options, const std::vector<std::string>& names,
                  int64_t frames, bool may_be_slices = false);

}  // namespace shvr
