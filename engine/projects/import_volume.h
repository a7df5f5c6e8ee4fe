#pragma once
// Makes a project of a volume: an OME-Zarr 0.4 image with all its levels, and what project.h lists.
//
// The source is gone through once, slab by slab; memory depends on the size of a slice, not on their number. Chunks
// have 64^3 voxels, are compressed with blosc (zstd, bytes shuffled), and are not written where all their voxels are 0.
// The project appears whole: until then it is PROJECT.part, with a state from which the same call goes on after it was
// stopped, killed, or the disk was full. Equal input gives equal bytes, whether in one go or in several.

#include <array>
#include <atomic>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "engine/base/error.h"
#include "engine/formats/zarr/zarr_metadata.h"
#include "engine/projects/import_prepare.h"
#include "engine/volume/halving.h"
#include "engine/volume/source.h"

namespace shvr {

/// The import was cancelled; what is there is kept.
class ImportStopped : public Error {
public:
    using Error::Error;
};

struct ImportProgress {
    double fraction = 0.0;           ///< of the voxels, those of an earlier run included
    double voxels_per_second = 0.0;  ///< of this run; level 0 of the project
    double seconds_left = 0.0;
};

/// Labels beside an image, for other programs and for readers of labels: no project.
struct LabelImage {
    struct Color {
        int64_t value;
        std::array<uint8_t, 4> rgba;
        std::string name;  ///< may be empty
    };
    std::vector<Color> colors{};
    std::string source{};  ///< the image they are of, as a path from the folder of labels; empty: not said
    /// The hash of that image's voxels (content_hash.h), by which a mask is told from those of other images of its
    /// size; empty: not said.
    std::string painted_on{};
};

struct ImportOptions {
    PreparationOptions preparation{};
    Halving halving = Halving::mean;  ///< how coarser levels are made; labels are whole numbers and as they are
    std::string choice{};  ///< how the file was read: channel, frame, layout; only compared with that of an earlier run
    bool overwrites = false;
    std::optional<LabelImage> label_image{};  ///< with Halving::label; see export_label_image
    int threads = 0;                          ///< 0: one a core
    ZarrCompressor compressor{.kind = ZarrCompressor::Kind::blosc};
    std::function<void(const ImportProgress&)> progress{};  ///< about every 100 ms, on the calling thread
    const std::atomic<bool>* cancel = nullptr;              ///< looked at before every task; they take milliseconds
};

struct ImportReport {
    std::filesystem::path project;  ///< absolute
    VolumeInfo info;                ///< of level 0
    int levels = 1;
    int64_t bricks = 0;         ///< chunks of all levels
    int64_t bricks_stored = 0;  ///< those that are not empty
    int64_t bytes = 0;          ///< of all files
    bool was_resumed = false;
    std::vector<std::string> warnings;
};

/// `origin` is the file that `source` was opened from. Fails with one sentence; throws `ImportStopped` where cancelled.
ImportReport import_volume(const VolumeSource& source, const std::filesystem::path& origin,
                           const std::filesystem::path& project, const ImportOptions& options);

/// Labels (whole numbers) as an OME-Zarr 0.4 label image with its levels and nothing else: no folder shvr/. It appears
/// whole, in exchange for a label image that was there; anything else that is there is refused. Where it is
/// IMAGE/labels/NAME, the list of IMAGE/labels/.zattrs names it, and it says that it is IMAGE's.
/// Of `options` only threads, compressor, progress and cancel are looked at. Nothing is left of one that fails.
ImportReport export_label_image(const VolumeSource& labels, const std::filesystem::path& folder,
                                const LabelImage& image, const ImportOptions& options = {});

}  // namespace shvr
