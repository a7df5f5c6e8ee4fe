#include "tools/bench/part.h"

#include <algorithm>
#include <cstring>
#include <span>

#include <nlohmann/json.hpp>

#include "engine/base/atomic_writer.h"
#include "engine/base/error.h"
#include "engine/base/file.h"

// The file: the floats of all pictures in order, JSON, and the length of that in 8 bytes.

namespace shvr::bench {

namespace {

using Json = nlohmann::ordered_json;

constexpr int64_t MAX_PART_BYTES = int64_t{4} << 30;

/// Describes a picture and appends its floats to the file.
Json put(const ImageF& picture, AtomicWriter& file)
{
    file.append(std::as_bytes(std::span(picture.rgba)));
    return {picture.width, picture.height};
}

Json put(const std::vector<std::pair<std::string, ImageF>>& pictures, AtomicWriter& file)
{
    Json all = Json::array();
    for (const auto& [name, picture] : pictures) all.push_back({name, put(picture, file)});
    return all;
}

/// Takes pictures from the start of the file, in the order in which they were put.
class PictureReader {
public:
    explicit PictureReader(std::span<const std::byte> bytes) : rest_(bytes) {}

    ImageF take(const Json& size)
    {
        ImageF picture{size.at(0), size.at(1), {}};
        const auto values = uint64_t(std::max(picture.width, 0)) * uint64_t(std::max(picture.height, 0)) * 4;
        if (values > rest_.size() / sizeof(float)) fail("a picture is cut off");
        picture.rgba.resize(values);
        if (values > 0) std::memcpy(picture.rgba.data(), rest_.data(), values * sizeof(float));
        rest_ = rest_.subspan(values * sizeof(float));
        return picture;
    }
    std::vector<std::pair<std::string, ImageF>> take_all(const Json& list)
    {
        std::vector<std::pair<std::string, ImageF>> pictures;
        for (const Json& each : list) pictures.emplace_back(each.at(0), take(each.at(1)));
        return pictures;
    }

private:
    std::span<const std::byte> rest_;
};

}  // namespace

void write_part(const Part& part, const std::filesystem::path& file)
{
    AtomicWriter writer(file);
    Json json{{"results", json_of(part.results)}, {"pictures", Json::array()}, {"sweeps", Json::array()}};
    for (const Pictures& pictures : part.pictures) {
        Json described = Json::object();
        described["reference"] = put(pictures.reference, writer);
        described["qualities"] = put(pictures.of_qualities, writer);
        described["peers"] = put(pictures.of_peers, writer);
        json["pictures"].push_back(described);
    }
    for (const Sweep& sweep : part.sweeps)
        json["sweeps"].push_back({{"name", sweep.name},
                                  {"what", sweep.what},
                                  {"error", sweep.error},
                                  {"svg", sweep.svg.empty() ? report::svg_of(sweep.plot) : sweep.svg},
                                  {"table", csv_of(sweep)}});
    const std::string text = json.dump(-1, ' ', false, Json::error_handler_t::replace);
    const uint64_t length = text.size();
    writer.append(std::as_bytes(std::span(text)));
    writer.append(std::as_bytes(std::span(&length, 1)));
    writer.commit();
}

Part read_part(const std::filesystem::path& file)
{
    const std::vector<std::byte> bytes = read_file(file, MAX_PART_BYTES);
    uint64_t length = 0;
    const size_t end = bytes.size() - std::min(bytes.size(), sizeof length);
    if (bytes.size() >= sizeof length) std::memcpy(&length, bytes.data() + end, sizeof length);
    const char* const expected = "; expected the piece of a task of shvr bench: remove it, and run the task again";
    if (length > end) fail(file.string(), ": is cut off", expected);
    const std::span<const std::byte> pixels = std::span(bytes).first(end - length);
    const auto* const text = reinterpret_cast<const char*>(bytes.data() + pixels.size());
    const Json json = Json::parse(text, text + length, nullptr, false);
    try {
        Part part{.results = results_of(json.at("results"), file.string()), .pictures = {}, .sweeps = {}};
        PictureReader reader(pixels);
        for (const Json& described : json.at("pictures")) {
            Pictures& pictures = part.pictures.emplace_back();
            pictures.reference = reader.take(described.at("reference"));
            pictures.of_qualities = reader.take_all(described.at("qualities"));
            pictures.of_peers = reader.take_all(described.at("peers"));
        }
        for (const Json& sweep : json.at("sweeps"))
            part.sweeps.push_back({.name = sweep.at("name"),
                                   .what = sweep.at("what"),
                                   .error = sweep.at("error"),
                                   .rows = {},
                                   .plot = {},
                                   .svg = sweep.at("svg"),
                                   .table = sweep.at("table")});
        return part;
    } catch (const std::exception& error) {
        fail(file.string(), ": is damaged: ", error.what(), expected);
    }
}

Part joined(std::vector<Part> parts)
{
    SHVR_CHECK(!parts.empty());
    const auto is_left = [](const auto& list, size_t at) { return at < list.size(); };
    Part all{.results = parts.front().results, .pictures = {}, .sweeps = {}};
    all.results.scenes.clear();
    for (size_t at = 0;; ++at) {
        bool has_any = false;
        for (Part& part : parts) {
            if (is_left(part.results.scenes, at)) {
                all.results.scenes.push_back(part.results.scenes[at]);
                all.pictures.push_back(std::move(part.pictures.at(at)));
                has_any = true;
            }
            if (is_left(part.sweeps, at)) {
                all.sweeps.push_back(std::move(part.sweeps[at]));
                has_any = true;
            }
        }
        if (!has_any) break;
    }
    for (size_t task = 1; task < parts.size(); ++task) {
        const Results &first = parts.front().results, &other = parts[task].results;
        if (first.processor == other.processor && first.device == other.device && first.driver == other.driver)
            continue;
        all.results.left_out.push_back(sentence("task ", task, " ran on ", other.processor, " with ", other.device,
                                                ", and task 0 on ", first.processor, " with ", first.device,
                                                ": times of their scenes are of different machines"));
    }
    return all;
}

}  // namespace shvr::bench
