#pragma once
// Writes OME-Zarr images of the stored blocks of a source. Makes coarser levels only where blocks are stored: in a
// volume of 2^20 voxels a side, one stored chunk gives 16 chunks. The files equal those of a dense import, byte for
// byte. The new image replaces an old one as a whole (atomic_folder.h). Any thread may call these.

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "engine/projects/import_volume.h"

namespace shvr {

/// Returns the chunks of IMPORT_CHUNK^3 voxels that intersect stored blocks, ordered so that all chunks below a chunk
/// of a coarser level are adjacent. Null if the source cannot list its stored blocks, or if the fill value is not 0.
std::optional<std::vector<Size3>> stored_chunks(const VolumeSource& source);
/// Whether a sparse import of these chunks is faster than a dense one with all threads: up to an eighth of all chunks.
bool are_few(const std::vector<Size3>& chunks, const Size3& size);

/// How to treat an image that is to be replaced but contains content of other programs (foreign_content.h).
enum class Foreign {
    refused,   ///< the write fails
    kept,      ///< the old image stays under another name (free_old_name)
    replaced,  ///< like `kept`, without comparing: the whole image is another program's
    excluded,  ///< the image is known to be SHVR's own, so nothing is compared
};

/// Writes a label image of these chunks. Voxels of coarser levels get the most frequent label below them. `target` and
/// `options` are those of `export_label_image`, already checked and completed.
ImportReport write_label_image(const VolumeSource& labels, const std::filesystem::path& target,
                               const std::vector<Size3>& chunks, const ImportOptions& options);

/// Like `export_label_image`, but on one thread, at a cost proportional to the number of stored blocks, which the
/// source must be able to list. Returns a message if the old image is kept under another name.
std::string save_label_image(const VolumeSource& labels, const std::filesystem::path& folder, const LabelImage& image,
                             const ImportOptions& options = {}, Foreign foreign = Foreign::refused);

/// Saves numbers as an OME-Zarr 0.4 image with level 0 only and the attribute "shvr": {"shvr_KIND": 1}. The source must
/// be able to list its stored blocks. Replaces only an image of that kind. Returns the same as save_label_image.
std::string save_number_image(const VolumeSource& numbers, const std::filesystem::path& folder, const std::string& kind,
                              const Progress& progress = {}, Foreign foreign = Foreign::refused);

}  // namespace shvr
