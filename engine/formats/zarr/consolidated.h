#pragma once
// Consolidated metadata: copies, in a group, of the metadata of everything below it, which other programs write, and
// read in place of the originals (.zmetadata of Zarr 2; "consolidated_metadata" in a group's zarr.json). Any thread.

#include <filesystem>

namespace shvr {

/// Brings the copies in the two groups above an image up to date with it, and with the group between them. Does nothing
/// where there are none, or where they are damaged, so that no reader uses them. Fails if they cannot be written.
void renew_consolidated_metadata(const std::filesystem::path& image);

}  // namespace shvr
