#include "engine/annotation/files/stated_content.h"

#include <fstream>
#include <string>

#include "engine/annotation/files/volume_place.h"
#include "engine/base/error.h"
#include "engine/formats/export/volume_export.h"
#include "engine/formats/tiff/tiff_description.h"
#include "engine/formats/zarr/ome_zarr_labels.h"

namespace shvr {

namespace {

constexpr size_t HEADER_BYTES = size_t{64} << 10;

/// The first lines of an NRRD file, up to its voxels; empty for any other file.
std::string nrrd_header(const std::filesystem::path& path)
{
    std::string header(HEADER_BYTES, '\0');
    std::ifstream file(path, std::ios::binary);
    file.read(header.data(), std::streamsize(header.size()));
    header.resize(size_t(file.gcount()));
    if (!header.starts_with("NRRD")) return {};
    std::erase(header, '\r');
    return header.substr(0, header.find("\n\n"));
}

/// What a TIFF states in its description; empty for any other file, and one that cannot be read.
std::string content_in_tiff(const std::filesystem::path& path)
{
    try {
        return content_of_tiff(path);
    } catch (const Error&) {
        return {};
    }
}

}  // namespace

std::optional<StatedContent> stated_content(const std::filesystem::path& path)
{
    std::error_code ignored;
    if (std::filesystem::is_directory(path, ignored) || is_in_archive(path))
        return is_ome_zarr_label(path) ? std::optional(StatedContent::mask) : std::nullopt;
    const std::string header = nrrd_header(path);
    if (header.empty()) {
        const std::string content = content_in_tiff(path);
        if (content == "mask") return StatedContent::mask;
        return content == "offsets" ? std::optional(StatedContent::offsets) : std::nullopt;
    }
    const std::string key = std::string("\n") + NRRD_CONTENT_KEY + ":=";
    const auto has = [&](const std::string& text) { return header.find(text) != std::string::npos; };
    if (has("\nSegment0_") || has(key + "mask")) return StatedContent::mask;
    if (has(key + "offsets")) return StatedContent::offsets;
    return std::nullopt;
}

}  // namespace shvr
