#pragma once
// Writes OME-Zarr images of the stored blocks of a source, with coarser levels made only from these blocks: 16 chunks
// for one stored chunk in a volume of 2^20 voxels a side. The files equal those of a dense import, byte for byte. The
// image replaces an old one as a whole (atomic_folder.h). Any thread may call these.

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "engine/projects/import_volume.h"

namespace shvr {

/// Returns the chunks of IMPORT_CHUNK^3 voxels that stored blocks touch. Chunks below the same chunk of a coarser level
/// are adjacent. Null if the source cannot list its stored blocks, or if the fill value is not 0.
std::optional<std::vector<Size3>> stored_chunks(const VolumeSource& source);
/// Whether writing only these chunks takes less time than a dense import with all threads: true up to an eighth of all.
bool are_few(const std::vector<Size3>& chunks, const Size3& size);

/// The handling of an image that is to be replaced but contains content of other programs (foreign_content.h).
enum class Foreign {
    refused,   ///< the write fails
    kept,      ///< the old image gets another name (free_old_name)
    replaced,  ///< likewise, whatever it contains: all of it is another program's
    excluded,  ///< the image is known to be as SHVR wrote it: nothing is compared
};

/// Writes a label image of these chunks; a voxel of a coarser level gets the most frequent label of the voxels below
/// it. `target` and `options` are those of `export_label_image`, already checked and completed.
ImportReport write_label_image(const VolumeSource& labels, const std::filesystem::path& target,
                               const std::vector<Size3>& chunks, const ImportOptions& options);

/// Like `export_label_image`, on one thread, for a source that can list its stored blocks, with a cost proportional to
/// the number of blocks. Returns a sentence if the old image is kept under another name.
std::string save_label_image(const VolumeSource& labels, const std::filesystem::path& folder, const LabelImage& image,
                             const ImportOptions& options = {}, Foreign foreign = Foreign::refused);

/// Saves numbers, from a source that can list its stored blocks, as an OME-Zarr 0.4 image with level 0 only and the
/// attribute "shvr": {"shvr_KIND": 1}. Replaces an image of that kind only. Returns the same as save_label_image.
std::string save_number_image(const VolumeSource& numbers, const std::filesystem::path& folder, const std::string& kind,
                              const Progress& progress = {}, Foreign foreign = Foreign::refused);

}  // namespace shvr
