#pragma once
// Consolidated metadata (.zmetadata of Zarr 2; "consolidated_metadata" in a group's zarr.json): a group's copies of all
// metadata below it. Other programs write the copies, and read them instead of the originals. Any thread.

#include <filesystem>

namespace shvr {

/// Updates the consolidated metadata in the two groups above an image, so that it describes the image and the group in
/// between. Leaves missing or damaged metadata alone, as no reader uses them. Fails if the metadata cannot be written.
void renew_consolidated_metadata(const std::filesystem::path& image);

}  // namespace shvr
