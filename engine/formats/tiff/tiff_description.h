#pragma once
// Reads descriptions of the whole stack from a TIFF's ImageDescription: "key=value" lines by ImageJ, XML by OME-TIFF.
// Takes the spacing from the description or the page's resolution fields. Any thread may call these.

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "engine/formats/tiff/tiff_page.h"
#include "engine/volume/volume.h"

namespace shvr {

struct TiffDescription {
    enum class Writer { unknown, imagej, ome };
    Writer writer = Writer::unknown;

    /// Counts are 1 if not stated. `channels` counts those with pages of their own, not the colours of a pixel.
    int64_t slices = 1, channels = 1, frames = 1;
    /// Element z + slices * (c + channels * t) is the page (from 0) of slice z, channel c and frame t. Empty if pages
    /// are in ImageJ's order: channels vary fastest, then slices, then frames.
    static constexpr uint32_t NO_PAGE = UINT32_MAX;
    std::vector<uint32_t> pages{};
    /// For an OME stack in several files: the files, and the index of the file that holds each of `pages`. Empty if all
    /// pages are in the file with the description.
    std::vector<std::filesystem::path> files{};
    std::vector<uint32_t> file_of_page{};
    std::vector<std::string> channel_names{};  ///< may be fewer than `channels`; names may be ""

    std::optional<double> spacing[3]{};  ///< ImageJ: only z
    std::string unit[3]{};               ///< as written; "" if not stated

    /// Position, orientation and exact spacing, as stated in our own files (engine/formats/export).
    struct Place {
        std::optional<glm::dvec3> spacing{}, origin{};
        std::optional<glm::dmat3> directions{};
        std::string frame{};
    };
    Place place{};
    std::string content{};  ///< "mask" or "offsets", as stated in our own files; "" if not stated

    bool counts_from_minus_32768 = false;  ///< signed 16-bit values with 32768 added, as ImageJ stores them
    std::vector<std::string> warnings{};
};

/// Whether a file is opened as a whole volume (an OME-TIFF then includes files it refers to) or as one of many slices.
enum class TiffRole { whole, slice };

/// `samples`: number of an OME-TIFF's channels that one pixel holds. Fails if a description of a known kind is damaged
/// or, in the role `whole`, if a file that it refers to is missing.
TiffDescription read_description(const TiffFile& file, std::string_view text, int samples, TiffRole role);

/// Returns `TiffDescription::content` of a file; "" if the file is no TIFF. Fails if the file is damaged.
std::string content_of_tiff(const std::filesystem::path& path);

/// Sets spacing and unit of `info`, and adds a warning for each assumption. `page` is the first page.
void apply_tiff_spacing(VolumeInfo& info, const TiffDescription& description, const TiffFile& file, uint64_t directory,
                        const TiffPage& page);

// The two kinds, for `read_description`.
TiffDescription read_imagej_description(const std::string& subject, std::string_view text);
TiffDescription read_ome_description(const TiffFile& file, std::string_view text, int samples, TiffRole role);

}  // namespace shvr
