#include "engine/pieces/picture_rows.h"

#include <algorithm>
#include <array>
#include <fstream>
#include <span>

#include <nlohmann/json.hpp>

#include "engine/base/error.h"
#include "engine/base/json.h"

// The file: floats (red, green, blue, alpha) row by row, the description as JSON, and the length of that in 8 bytes.

namespace shvr {

namespace {

constexpr int64_t LENGTH_BYTES = sizeof(uint64_t), MAX_DESCRIPTION_BYTES = int64_t{64} << 20;

int64_t pixel_bytes(const PictureRows& rows)
{
    return 4 * int64_t(sizeof(float)) * rows.width * (rows.upper - rows.lower);
}

std::ifstream opened(const std::filesystem::path& file)
{
    std::ifstream stream(file, std::ios::binary);
    if (!stream) fail(file.string(), ": cannot be read; expected the piece of a task of shvr render");
    return stream;
}

[[noreturn]] void refuse(const std::filesystem::path& file)
{
    fail(file.string(), ": is not the piece of a task of shvr render; expected one: remove it, and run the task again");
}

}  // namespace

void PictureRowsWriter::add(const ImageF& rows)
{
    file_.append(std::as_bytes(std::span(rows.rgba)));
}

void PictureRowsWriter::commit(const PictureRows& description)
{
    nlohmann::ordered_json json = {{"shvr_rows", 1},
                                   {"width", description.width},
                                   {"height", description.height},
                                   {"lower", description.lower},
                                   {"upper", description.upper},
                                   {"device", description.device},
                                   {"complete", description.is_complete},
                                   {"warnings", description.warnings},
                                   {"texts", nlohmann::ordered_json::array()}};
    for (const auto& [keyword, text] : description.texts) json["texts"].push_back({keyword, text});
    const std::string text = json.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
    const uint64_t length = text.size();
    file_.append(std::as_bytes(std::span(text)));
    file_.append(std::as_bytes(std::span(&length, 1)));
    file_.commit();
}

PictureRows read_rows_description(const std::filesystem::path& file)
{
    std::ifstream stream = opened(file);
    std::error_code error;
    const auto bytes = int64_t(std::filesystem::file_size(file, error));
    uint64_t length = 0;
    if (error || bytes < LENGTH_BYTES) refuse(file);
    stream.seekg(bytes - LENGTH_BYTES);
    stream.read(reinterpret_cast<char*>(&length), LENGTH_BYTES);
    if (!stream || length > uint64_t(std::min(bytes - LENGTH_BYTES, MAX_DESCRIPTION_BYTES))) refuse(file);
    std::string text(length, '\0');
    stream.seekg(bytes - LENGTH_BYTES - int64_t(length));
    stream.read(text.data(), std::streamsize(length));
    if (!stream) refuse(file);
    const JsonDocument document(text, file.string());
    const JsonNode root = document.root();
    root.required("shvr_rows", "1, as shvr writes it").whole(1, 1);
    PictureRows rows{.width = root["width"].whole(1, MAX_IMAGE_SIDE),
                     .height = root["height"].whole(1, MAX_IMAGE_SIDE)};
    rows.lower = root["lower"].whole(0, rows.height);
    rows.upper = root["upper"].whole(rows.lower, rows.height);
    rows.device = root["device"].any_text();
    rows.is_complete = root["complete"].flag();
    for (const JsonNode& warning : root["warnings"].elements()) rows.warnings.push_back(warning.any_text());
    for (const JsonNode& pair : root["texts"].elements()) {
        const std::vector<JsonNode> both = pair.elements(2, 2);
        rows.texts.emplace_back(both[0].any_text(), both[1].any_text());
    }
    if (bytes != pixel_bytes(rows) + int64_t(length) + LENGTH_BYTES) refuse(file);
    return rows;
}

void read_rows(const std::filesystem::path& file, const PictureRows& description,
               const std::function<void(const ImageF& rows)>& take)
{
    constexpr int64_t MAX_BAND_VALUES = int64_t{1} << 21;
    std::ifstream stream = opened(file);
    const int64_t row_values = 4 * description.width, at_once = std::max<int64_t>(MAX_BAND_VALUES / row_values, 1);
    for (int64_t row = description.lower; row < description.upper; row += at_once) {
        const int64_t count = std::min(at_once, description.upper - row);
        ImageF band{int(description.width), int(count), std::vector<float>(size_t(count * row_values))};
        stream.read(reinterpret_cast<char*>(band.rgba.data()), std::streamsize(band.rgba.size() * sizeof(float)));
        if (!stream) refuse(file);
        take(band);
    }
}

}  // namespace shvr
