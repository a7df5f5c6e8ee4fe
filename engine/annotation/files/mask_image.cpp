#include "engine/annotation/files/mask_image.h"

#include <nlohmann/json.hpp>

#include "engine/base/atomic_file.h"
#include "engine/base/error.h"
#include "engine/base/text.h"
#include "engine/formats/zarr/store/zarr_node.h"

namespace shvr {

namespace {

constexpr int64_t LARGEST_RECORD = int64_t{1} << 16;
constexpr int VERSION = 1;

bool is_folder(const std::filesystem::path& path)
{
    std::error_code ignored;
    return std::filesystem::is_directory(path, ignored);
}

}  // namespace

std::filesystem::path mask_image_path(const std::filesystem::path& mask)
{
    std::filesystem::path path = mask;
    path += ".json";
    return path;
}

void save_mask_image(const std::filesystem::path& mask, const std::string& content_hash)
{
    if (content_hash.empty() || is_folder(mask)) return;
    const nlohmann::ordered_json record = {{"shvr_mask", VERSION}, {"image", content_hash}};
    const std::string text = record.dump(2) + "\n";
    write_file_atomically(mask_image_path(mask), std::as_bytes(std::span(text)));
}

void check_mask_image(const std::filesystem::path& mask, const std::string& content_hash)
{
    if (content_hash.empty()) return;
    std::optional<JsonDocument> document;  // of a file beside the mask
    const std::optional<ZarrNode> node = read_zarr_node(mask);
    const bool is_label_image = node.has_value();
    if (!is_label_image) {
        const std::filesystem::path path = mask_image_path(mask);
        std::error_code ignored;
        if (is_folder(mask) || !std::filesystem::exists(path, ignored)) return;
        document.emplace(read_zarr_json(path, LARGEST_RECORD));
    }
    const JsonNode record = is_label_image ? node->attributes()["shvr"] : document->root();
    if (is_label_image && !record.exists()) return;
    if (!record.is_object()) record.refuse("an object");
    record["shvr_mask"].whole(VERSION, VERSION);
    const JsonNode image = record.required("image", "the hash of an image");
    if (!image.is(content_hash))
        image.refuse(sentence(in_quotes(content_hash),
                              ", the volume's: the mask was painted on other voxels (without this ",
                              is_label_image ? "member" : "file", " only its size is compared)"));
}

}  // namespace shvr
