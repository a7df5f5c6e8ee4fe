#pragma once
// The choices in a TIFF that holds more than one volume, and the user's choice. Any thread may call these.

#include "engine/formats/tiff/tiff_description.h"
#include "engine/formats/tiff/tiff_samples.h"
#include "engine/volume/source.h"

namespace shvr {

/// A volume that pixels can hold: one of their samples, or one colour of the palette.
struct TiffPixelChannel {
    std::string name{};  ///< "" if it has only a number
    int sample = 0;
    int palette_color = -1;
    bool is_usual = false;  ///< the default if none is chosen
};

/// At least one. May add to `warnings`: a palette whose numbers are the intensities themselves offers no choice.
std::vector<TiffPixelChannel> channels_of_pixel(const TiffPage& page, const TiffLayout& layout,
                                                const TiffDescription& description, std::vector<std::string>& warnings);

/// Returns `options`. If they choose no channel and one of `channels` is usual, that one is chosen, with a warning.
OpenOptions with_usual_channel(const OpenOptions& options, const std::vector<TiffPixelChannel>& channels,
                               std::vector<std::string>& warnings);

struct TiffChoice {
    size_t channel = 0;  ///< index into `names`
    int64_t frame = 0;   ///< from 0
};

/// The choice of a channel or a time point that takes all of them as the slices of one volume.
inline constexpr const char* AS_SLICES = "slices";
/// Fails, listing the choices, if there are several and none is chosen, or if the chosen one does not exist.
/// `may_be_slices`: AS_SLICES, which the caller applies, is one of the choices.
TiffChoice choose(const std::string& subject, const OpenOptions& options, const std::vector<std::string>& names,
                  int64_t frames, bool may_be_slices = false);

}  // namespace shvr
