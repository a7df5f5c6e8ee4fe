#pragma once
// The choices that a TIFF with more than one volume offers, and the user's choice. Any thread may call these functions.

#include "engine/formats/tiff/tiff_description.h"
#include "engine/formats/tiff/tiff_samples.h"
#include "engine/volume/source.h"

namespace shvr {

/// One of the values that a pixel can yield: one of its samples, or one colour of its palette entry.
struct TiffPixelChannel {
    std::string name{};  ///< "" if the channel has only a number
    int sample = 0;
    int palette_color = -1;
    bool is_usual = false;  ///< whether this is the default channel
};

/// Returns at least one channel; may add to `warnings`. A palette that only colours the display yields one channel.
std::vector<TiffPixelChannel> channels_of_pixel(const TiffPage& page, const TiffLayout& layout,
                                                const TiffDescription& description, std::vector<std::string>& warnings);

/// Returns `options`. If they choose no channel and `channels` has a default, chooses the default and adds a warning.
OpenOptions with_usual_channel(const OpenOptions& options, const std::vector<TiffPixelChannel>& channels,
                               std::vector<std::string>& warnings);

struct TiffChoice {
    size_t channel = 0;  ///< index into `names`
    int64_t frame = 0;   ///< from 0
};

/// The choice that turns all channels, or all time points, into the slices of one volume.
inline constexpr const char* AS_SLICES = "slices";
/// Returns the choice. Fails, listing the choices, if several exist and none is chosen, or if the chosen one is
/// missing. `may_be_slices`: whether AS_SLICES is allowed; applying it is left to the caller.
TiffChoice choose(const std::string& subject, const OpenOptions& options, const std::vector<std::string>& names,
                  int64_t frames, bool may_be_slices = false);

}  // namespace shvr
