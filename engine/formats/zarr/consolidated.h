#pragma once
// Consolidated metadata (.zmetadata in Zarr 2; "consolidated_metadata" in a group's zarr.json): a group's copies of all
// metadata below it, which other programs write, and read instead of the originals. Any thread.

#include <filesystem>

namespace shvr {

/// Updates the consolidated metadata of the two groups above an image, so that it describes the image and the group in
/// between. Skips missing or damaged consolidated metadata, which no reader uses. Fails if writing fails.
void renew_consolidated_metadata(const std::filesystem::path& image);

}  // namespace shvr
