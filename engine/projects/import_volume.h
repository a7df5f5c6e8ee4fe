#pragma once
// Makes a project from a volume: an OME-Zarr image, 0.4 or 0.5, with all its levels, and the files listed in project.h.
//
// The source is read once, slab by slab; memory depends on the size of a slice, not on the number of slices. Chunks
// have 64^3 voxels, are compressed with blosc (zstd, bytes shuffled), and are not written if all their voxels are 0.
// Until the project is complete it is PROJECT.part, with a saved state from which the same call resumes after it was
// stopped or killed, or after the disk was full. Equal input gives equal bytes, in one run or several.

#include <array>
#include <atomic>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "engine/base/error.h"
#include "engine/formats/nrrd_head.h"
#include "engine/formats/zarr/metadata/zarr_metadata.h"
#include "engine/formats/zarr/ome_zarr.h"
#include "engine/projects/import_prepare.h"
#include "engine/volume/gaps.h"
#include "engine/volume/halving.h"
#include "engine/volume/source.h"

namespace shvr {

/// Thrown if the import was cancelled. Completed work is kept.
class ImportStopped : public Error {
public:
    using Error::Error;
};

struct ImportProgress {
    double fraction = 0.0;           ///< completed fraction of the voxels, including those of earlier runs
    double voxels_per_second = 0.0;  ///< voxels of level 0 per second in this run; 0 before anything is written
    double seconds_left = 0.0;
};

/// A label image: labels stored with an image, for other programs and for reading as a mask. It is not a project.
struct LabelImage {
    struct Color {
        int64_t value;
        std::array<uint8_t, 4> rgba;
        std::string name;  ///< may be empty
    };
    std::vector<Color> colors{};
    std::string source{};  ///< path of the labelled image relative to the folder of labels; empty: not stated
    /// The hash of the voxels of the image that was painted on (content_hash.h). It distinguishes a mask from masks of
    /// other images of the same size. Empty: not stated.
    std::string painted_on{};
    /// The journal of the work at the time of saving: the name of its file, and the number and checksum of its last
    /// record.
    struct Journal {
        std::string name;
        uint64_t record = 0, checksum = 0;
        bool operator==(const Journal&) const = default;
        /// Returns 16 hexadecimal digits, for JSON: some readers do not support 64-bit integers.
        std::string checksum_digits() const;
    };
    std::optional<Journal> journal{};  ///< stated only if `painted_on` is stated
    /// The header of an NRRD mask that these labels replace or were loaded from. It may describe segments in fields
    /// that SHVR does not interpret, and is kept for a later export. Null: none.
    std::optional<NrrdHead> header{};
};

struct ImportOptions {
    PreparationOptions preparation{};
    Halving halving = Halving::mean;  ///< how coarser levels are made; use Halving::label for labels
    std::string choice{};             ///< how the file was read: channel, frame, layout; must be the same to resume
    bool overwrites = false;
    std::optional<LabelImage> label_image{};  ///< with Halving::label; see export_label_image
    int threads = 0;                          ///< 0: one per core
    int64_t budget_host_bytes = 0;            ///< 0: three quarters of the machine's memory; see import_memory.h
    ZarrCompressor compressor{.kind = ZarrCompressor::Kind::blosc};
    /// Null: 0.4; for label images, the version of the image to which they belong, or else of the replaced label image.
    std::optional<OmeZarrVersion> version{};
    bool has_shards = false;  ///< OME-Zarr 0.5 only: stores up to 512 chunks in a file (import_files.h)
    /// Called about every 100 ms, on the calling thread; may throw `Stopped`, which cancels the import.
    std::function<void(const ImportProgress&)> progress{};
    const std::atomic<bool>* cancel = nullptr;  ///< checked before every task, every few milliseconds
    /// Collects what `source`, a GapSource, could not read; null: unreadable voxels end the import. The import reports
    /// gaps, and the project states them. An import with gaps is never resumed, since only the current run knows them.
    const Gaps* gaps = nullptr;
    /// Whether messages about unfinished work say how to go on with it by commands. Otherwise they say that it can be
    /// resumed or deleted, for callers that offer both.
    bool tells_commands = true;
};

struct ImportReport {
    std::filesystem::path project;  ///< absolute
    VolumeInfo info;                ///< of level 0
    int levels = 1;
    int64_t bricks = 0;         ///< chunks of all levels
    int64_t bricks_stored = 0;  ///< non-empty chunks
    int64_t bytes = 0;          ///< total size of all files
    bool was_resumed = false;
    std::vector<std::string> warnings;
    int64_t voxels_not_read = 0;  ///< unreadable voxels, which have the lowest value of their type, or NaN
};

/// `origin`: the file from which `source` was opened. Fails with one sentence; throws `ImportStopped` if cancelled.
ImportReport import_volume(const VolumeSource& source, const std::filesystem::path& origin,
                           const std::filesystem::path& project, const ImportOptions& options);

/// Whether a path has the name of a label image: NAME.zarr, or IMAGE/labels/NAME.
bool is_label_image(const std::filesystem::path& path);

/// Exports labels (whole numbers) as an OME-Zarr label image with its levels, without a folder shvr/. The image appears
/// only when complete. It may replace a label image; a path with any other content is refused. If the path is
/// IMAGE/labels/NAME, the label image is added to the list in IMAGE/labels, refers to IMAGE, and must have IMAGE's
/// version. Uses only threads, compressor, version, progress and cancel of `options`. A failed export leaves nothing
/// behind.
ImportReport export_label_image(const VolumeSource& labels, const std::filesystem::path& folder,
                                const LabelImage& image, const ImportOptions& options = {});

}  // namespace shvr
