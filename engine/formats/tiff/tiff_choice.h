#pragma once
// What a TIFF offers where it holds more than one volume, and which one a person chose. Any thread may call these.

#include "engine/formats/tiff/tiff_description.h"
#include "engine/formats/tiff/tiff_samples.h"
#include "engine/volume/source.h"

namespace shvr {

/// A volume that a pixel holds: one of its samples, or a colour that its palette gives it.
struct TiffPixelChannel {
    std::string name{};  ///< "" where it has a number only
    int sample = 0;
    int palette_color = -1;
};

/// At least one. `warnings` may grow: a palette whose numbers are the intensities themselves offers no choice.
std::vector<TiffPixelChannel> channels_of_pixel(const TiffPage& page, const TiffLayout& layout,
                                                const TiffDescription& description, std::vector<std::string>& warnings);

struct TiffChoice {
    size_t channel = 0;  ///< index into `names`
    int64_t frame = 0;   ///< from 0
};

/// Fails with the choices in words where there are several and none is chosen, or where the one chosen is not there.
TiffChoice choose(const std::string& subject, const OpenOptions& options, const std::vector<std::string>& names,
                  int64_t frames);

}  // namespace shvr
