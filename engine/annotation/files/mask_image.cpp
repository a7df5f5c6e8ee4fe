#include "engine/annotation/files/mask_image.h"

#include <charconv>

#include <nlohmann/json.hpp>

#include "engine/base/atomic_file.h"
#include "engine/base/error.h"
#include "engine/base/text.h"
#include "engine/formats/zarr/store/zarr_node.h"

namespace shvr {

namespace {

constexpr int64_t MAX_RECORD_BYTES = int64_t{1} << 16;
constexpr int VERSION = 1;

std::optional<uint64_t> number_of_hex(const std::string& digits)
{
    uint64_t number = 0;
    const auto result = std::from_chars(digits.data(), digits.data() + digits.size(), number, 16);
    const bool is_whole = digits.size() == 16 && result.ec == std::errc() && result.ptr == digits.data() + 16;
    return is_whole ? std::optional(number) : std::nullopt;
}

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

void save_mask_image(const std::filesystem::path& mask, const std::string& content_hash,
                     const std::optional<MaskJournal>& journal)
{
    if (content_hash.empty() || is_folder(mask)) return;
    nlohmann::ordered_json record = {{"shvr_mask", VERSION}, {"image", content_hash}};
    if (journal)
        record["journal"] = {
            {"name", journal->name}, {"record", journal->record}, {"checksum", journal->checksum_digits()}};
    // A name need not be valid UTF-8.
    const std::string text = record.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
    write_file_atomically(mask_image_path(mask), std::as_bytes(std::span(text)));
}

std::filesystem::path journal_is_named_in(const std::filesystem::path& mask)
{
    return is_folder(mask) ? mask : mask_image_path(mask);
}

std::optional<MaskJournal> journal_of_mask(const std::filesystem::path& mask)
{
    const auto named_by = [](const JsonNode& journal) -> std::optional<MaskJournal> {
        if (!journal.exists()) return std::nullopt;
        return MaskJournal{journal["name"].text(), uint64_t(journal["record"].whole(1, int64_t{1} << 53)),
                           journal["checksum"].parsed(number_of_hex, "16 hexadecimal digits")};
    };
    std::error_code ignored;
    if (mask.empty()) return std::nullopt;
    try {
        if (is_folder(mask)) {
            const std::optional<ZarrNode> node = read_zarr_node(mask);
            return node ? named_by(node->attributes()["shvr"]["journal"]) : std::nullopt;
        }
        const std::filesystem::path path = mask_image_path(mask);
        if (!std::filesystem::exists(path, ignored)) return std::nullopt;
        const JsonDocument document = read_zarr_json(path, MAX_RECORD_BYTES);
        return named_by(document.root()["journal"]);
    } catch (const Error&) {
        return std::nullopt;
    }
}

void check_mask_image(const std::filesystem::path& mask, const std::string& content_hash,
                      const std::function<bool(const std::string& hash)>& is_other_name)
{
    if (content_hash.empty()) return;
    std::optional<JsonDocument> document;  // of a file next to the mask
    const std::optional<ZarrNode> node = read_zarr_node(mask);
    const bool is_label_image = node.has_value();
    if (!is_label_image) {
        const std::filesystem::path path = mask_image_path(mask);
        std::error_code ignored;
        if (is_folder(mask) || !std::filesystem::exists(path, ignored)) return;
        document.emplace(read_zarr_json(path, MAX_RECORD_BYTES));
    }
    const JsonNode record = is_label_image ? node->attributes()["shvr"] : document->root();
    if (is_label_image && !record.exists()) return;
    if (!record.is_object()) record.refuse("an object");
    record["shvr_mask"].whole(VERSION, VERSION);
    const JsonNode image = record.required("image", "the hash of an image");
    if (image.is(content_hash) || (image.is_text() && is_other_name && is_other_name(image.any_text()))) return;
    image.refuse(sentence(in_quotes(content_hash),
                          ", the volume's: the mask was painted on other voxels (without this ",
                          is_label_image ? "member" : "file", " only its size is compared)"));
}

}  // namespace shvr
