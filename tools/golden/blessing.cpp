#include "tools/golden/blessing.h"

#include <cstdlib>
#include <fstream>
#include <sstream>

#include <nlohmann/json.hpp>

#include "engine/base/atomic_file.h"
#include "engine/base/file.h"
#include "engine/base/image_file.h"
#include "engine/base/json.h"
#include "shaders/counters.h"

namespace shvr::golden {

namespace {

using Json = nlohmann::ordered_json;
constexpr int64_t MAX_PICTURE_BYTES = int64_t{64} << 20;
constexpr int64_t MAX_SIDE_CAR_BYTES = 1 << 20;

Json parsed_side_car(const Golden& golden)
{
    const Json side_car = Json::parse(read_text(golden.side_car(), MAX_SIDE_CAR_BYTES), nullptr, false);
    if (!side_car.is_object() || !side_car.contains("fnv1a64") || !side_car["fnv1a64"].is_string())
        fail(golden.side_car().string(), ": is no side-car; expected what shvr golden bless writes");
    return side_car;
}

Json json_of(const std::vector<std::pair<std::string, uint64_t>>& counters)
{
    Json json = Json::object();
    for (const auto& [name, value] : counters) json[name] = value;
    return json;
}

Json history_of(const Blessed& blessed)
{
    if (blessed.old_hash == "none") return nullptr;
    Json history{{"fnv1a64", blessed.old_hash}};
    if (!blessed.change) return history;
    history["max_abs"] = blessed.change->max_abs;
    history["psnr_db"] = blessed.change->psnr_db ? Json(*blessed.change->psnr_db) : Json(nullptr);
    history["mean_error"] = blessed.change->mean_error;
    history["fraction_over_1"] = blessed.change->fraction_over_1;
    return history;
}

bool is_up_to_date(const Golden& golden, const Drawn& drawn)
{
    if (why_not_blessed(golden) || why_different(drawn.image, read_png(golden.picture()), golden.strictness) ||
        why_other_work(golden, drawn))
        return false;
    const Json side_car = parsed_side_car(golden);
    const size_t counters = drawn.work_is_exact ? drawn.work.size() : 0;  // the side-car lacks counters added later
    return (side_car.contains("work") ? side_car["work"].size() : 0) == counters &&
           side_car.value("class", "") == spelled(golden.strictness);
}

void refuse_where_nothing_is_blessed(Studio& studio, const std::string& reason)
{
    if (reason.empty()) throw UsageError("--reason is missing; expected why the picture changes");
    if (const char* ci = std::getenv("CI"); ci && *ci)
        fail("CI is set in the environment, and continuous integration never blesses; bless on your own machine");
    if (!studio.is_lavapipe())
        fail("goldens are blessed on Mesa's lavapipe alone, and the device is ",
             studio.renderer().device().traits().name, "; expected one called ", LAVAPIPE);
}

}  // namespace

Maker maker_of(Renderer& renderer)
{
    Maker maker{.device = renderer.device().traits().name, .driver = renderer.device().traits().driver};
    std::ifstream processors("/proc/cpuinfo");
    for (std::string line; std::getline(processors, line) && (maker.processor.empty() || maker.instructions.empty());) {
        const size_t colon = line.find(": ");
        if (colon == std::string::npos) continue;
        if (line.starts_with("model name")) maker.processor = line.substr(colon + 2);
        if (!line.starts_with("flags")) continue;
        std::istringstream flags(line.substr(colon + 2));
        for (std::string flag; flags >> flag;)
            if (flag == "sse4_1" || flag == "avx" || flag == "avx2" || flag == "fma" || flag == "avx512f")
                maker.instructions += (maker.instructions.empty() ? "" : " ") + flag;
    }
    return maker;
}

std::vector<std::pair<std::string, uint64_t>> work_of(std::span<const gpu::PassReport> passes)
{
    constexpr std::pair<uint32_t, const char*> NAMES[] = {{gpu::COUNTER_RAYS, "rays"},
                                                          {gpu::COUNTER_SAMPLES, "samples"},
                                                          {gpu::COUNTER_SHADED, "shaded_samples"},
                                                          {gpu::COUNTER_DENSITY_READS, "density_reads"},
                                                          {gpu::COUNTER_LEAPS, "leaps"},
                                                          {gpu::COUNTER_BRICKS_VISITED, "bricks_visited"},
                                                          {gpu::COUNTER_BRICKS_SKIPPED, "bricks_skipped"},
                                                          {gpu::COUNTER_TERMINATED, "rays_terminated_early"},
                                                          {gpu::COUNTER_CUT_SHORT, "rays_cut_short"}};
    std::vector<std::pair<std::string, uint64_t>> counters;
    for (const auto& [index, name] : NAMES) {
        uint64_t sum = 0;
        for (const gpu::PassReport& pass : passes)
            if (!pass.counters.empty()) sum += pass.counters[index];
        counters.emplace_back(name, sum);
    }
    return counters;
}

std::vector<std::pair<std::string, uint64_t>> counters_of(const Picture& picture)
{
    std::vector<std::pair<std::string, uint64_t>> counters = work_of(picture.passes);
    uint64_t dispatches = 0;  // as declared, since busy machines split long passes into more
    for (const gpu::PassReport& pass : picture.passes) dispatches += pass.tiles;
    counters.emplace_back("passes", picture.passes.size());
    counters.emplace_back("dispatches", dispatches);
    return counters;
}

std::optional<std::string> why_not_blessed(const Golden& golden)
{
    for (const std::filesystem::path& path : {golden.picture(), golden.side_car()})
        if (!std::filesystem::exists(path)) return path.string() + " is missing";
    const std::string found = hash_of(read_file(golden.picture(), MAX_PICTURE_BYTES));
    const std::string expected = parsed_side_car(golden)["fnv1a64"].get<std::string>();
    if (found != expected)
        return sentence(golden.picture().string(), " has hash ", found, "; its side-car says ", expected);
    return std::nullopt;
}

std::optional<std::string> why_other_work(const Golden& golden, const Drawn& drawn)
{
    if (!drawn.work_is_exact) return std::nullopt;
    const Json side_car = parsed_side_car(golden);
    const Json work = side_car.contains("work") && side_car["work"].is_object() ? side_car["work"] : Json::object();
    std::string differing, missing;
    for (const auto& [name, value] : drawn.work) {
        const auto recorded = work.find(name);
        if (recorded == work.end())
            missing += (missing.empty() ? "" : ", ") + name;
        else if (*recorded != value)
            differing +=
                sentence(differing.empty() ? "" : ", ", name, " ", value, " (recorded: ", recorded->dump(), ")");
    }
    // The counters are checked on every machine, since a counter without a recorded value detects nothing.
    if (!missing.empty())
        return sentence(golden.side_car().string(), ": work lacks ", missing,
                        "; expected every counter of the picture, as ", bless_command(golden), " records them");
    if (differing.empty() || side_car.value("driver", "") != drawn.maker.driver ||
        side_car.value("instructions", "") != drawn.maker.instructions)
        return std::nullopt;
    return "other work: " + differing;
}

Drawn drawn_by(Studio& studio)
{
    const Picture picture = studio.draw_counted();
    return {.image = to_image8(picture.image),
            .light = picture.image,
            .maker = maker_of(studio.renderer()),
            .work = counters_of(picture),
            // Which bricks of a paged volume are present when a pass begins depends on the disk and the threads.
            .work_is_exact = !studio.renderer().volume().counts()};
}

Blessed bless(const Golden& golden, const std::string& reason, const StudioOptions& options)
{
    Studio studio(golden, options);
    refuse_where_nothing_is_blessed(studio, reason);
    const Drawn drawn = drawn_by(studio);
    std::vector<std::byte> png = encode_png(drawn.image, golden.name);
    Blessed blessed{.name = golden.name, .old_hash = "none", .new_hash = {}, .change = {}};
    if (std::filesystem::exists(golden.picture())) {
        blessed.old_hash = hash_of(read_file(golden.picture(), MAX_PICTURE_BYTES));
        const Image8 before = read_png(golden.picture());
        if (before.width == drawn.image.width && before.height == drawn.image.height)
            blessed.change = compare_pixels(drawn.image, before);
        if (is_up_to_date(golden, drawn)) {
            blessed.new_hash = "unchanged";
            return blessed;
        }
        // Keeps the old picture if the new one passes. Otherwise, many changes within the class's limits could add up.
        if (!why_different(drawn.image, before, golden.strictness))
            png = read_file(golden.picture(), MAX_PICTURE_BYTES);
    }
    blessed.new_hash = hash_of(png);
    Json side_car{{"reason", reason},
                  {"device", drawn.maker.device},
                  {"driver", drawn.maker.driver},
                  {"processor", drawn.maker.processor},
                  {"instructions", drawn.maker.instructions},
                  {"class", spelled(golden.strictness)},
                  {"fnv1a64", blessed.new_hash}};
    if (drawn.work_is_exact) side_car["work"] = json_of(drawn.work);
    side_car["previous"] = history_of(blessed);
    const std::string text = side_car.dump(2) + "\n";
    write_file_atomically(golden.picture(), png);
    write_file_atomically(golden.side_car(), std::as_bytes(std::span(text)));
    return blessed;
}

std::string bless_command(const Golden& golden)
{
    return sentence("shvr golden bless '", golden.name, "' --folder '", golden.folder.string(), "' --reason \"...\"");
}

}  // namespace shvr::golden
