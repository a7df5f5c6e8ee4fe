#include "tools/bench/measure.h"

#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <map>
#include <memory>
#include <random>
#include <thread>

#include "engine/base/atomic_file.h"
#include "engine/base/file.h"
#include "engine/base/image_metrics.h"
#include "engine/base/text.h"
#include "tools/bench/reference_scene.h"
#include "tools/bench/yardstick.h"
#include "tools/golden/blessing.h"

namespace shvr::bench {

namespace {

// Far below the errors to be measured. 1e-12 would take three times as long.
constexpr double REFERENCE_TOLERANCE = 1e-8;
/// Increment whenever the output of the reference renderer changes, so that stored references are drawn again.
constexpr int REFERENCE_VERSION = 1;
constexpr size_t ROWS_AT_A_TIME = 4;
constexpr const char* YARDSTICK = "yardstick";  // among the runs' names

double seconds_since(std::chrono::steady_clock::time_point begun)
{
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - begun).count();
}

std::filesystem::path kept_reference(const golden::Studio& studio, const Scene& scene, const MeasureOptions& options)
{
    std::string all = sentence(REFERENCE_VERSION, "\n", scene.drawn.session_text, scene.drawn.session_path.string(),
                               "\n", studio.session().volume_hash, "\n");
    for (const std::string& setting : scene.drawn.settings) all += setting + "\n";
    for (const ScriptLine& line : scene.drawn.script) all += line_of(line.op) + "\n";
    return options.kept / sentence("reference-", golden::hash_of(std::as_bytes(std::span(all))), ".light");
}

/// Reads a stored picture: its width and height, then floats. Null if the file holds no picture of this size.
std::optional<ImageF> read_kept(const std::filesystem::path& path, const glm::uvec2& size)
{
    const size_t values = size_t(size.x) * size.y * 4;
    if (!is_file(path) || std::filesystem::file_size(path) != values * sizeof(float)) return std::nullopt;
    const std::vector<std::byte> bytes = read_file(path, int64_t(values * sizeof(float)));
    ImageF image{int(size.x), int(size.y), std::vector<float>(values)};
    std::memcpy(image.rgba.data(), bytes.data(), bytes.size());
    return image;
}

ImageF drawn_reference(const golden::Studio& studio, const MeasureOptions& options)
{
    const Session& session = studio.session();
    const Camera camera = studio.camera();
    const OpenedSession& opened = studio.opened();
    const Mask& mask = studio.document().mask;
    const ReferenceScene scene = reference_scene_of(session, *opened.source, opened.statistics, camera, &mask);
    const glm::uvec2 size = session.render.size;
    const RayPlanes planes = ray_planes(camera, size, opened.source->info());
    ImageF image{int(size.x), int(size.y), {}};
    for (uint32_t y = 0; y < size.y; y += ROWS_AT_A_TIME) {
        if (options.tell) options.tell("drawing the reference", double(y) / size.y);
        std::vector<glm::uvec2> pixels;
        for (uint32_t row = y; row < std::min<uint32_t>(y + ROWS_AT_A_TIME, size.y); ++row)
            for (uint32_t x = 0; x < size.x; ++x) pixels.emplace_back(x, row);
        const std::vector<reference::Ray> rays = rays_through(pixels, planes);
        for (const glm::dvec4& light : draw(scene, rays, reference::ExactOptions{.tolerance = REFERENCE_TOLERANCE},
                                            session.render.background, options.threads))
            for (int channel = 0; channel < 4; ++channel) image.rgba.push_back(float(light[channel]));
    }
    return image;
}

ImageF reference_of(const golden::Studio& studio, const Scene& scene, const MeasureOptions& options, double& seconds)
{
    const std::filesystem::path path = kept_reference(studio, scene, options);
    if (std::optional<ImageF> kept = read_kept(path, studio.session().render.size)) return *std::move(kept);
    const auto begun = std::chrono::steady_clock::now();
    ImageF image = drawn_reference(studio, options);
    seconds = seconds_since(begun);
    write_file_atomically(path, std::as_bytes(std::span(image.rgba)));
    return image;
}

/// A run whose device is ready, so that its picture can be drawn at any time.
struct Prepared {
    const Run* run;
    golden::Studio* studio;
    Session session;
    size_t passes = 0;  ///< number of passes in a picture without preparation
    int redraws = 0;
};

/// Shares devices between runs: one studio for each combination of settings that affect how a device holds a volume.
class Studios {
public:
    Studios(const Scene& scene, const MeasureOptions& options) : scene_(scene), options_(options) {}

    Prepared prepare(const Run& run)
    {
        golden::Golden drawn = scene_.drawn;
        drawn.settings.insert(drawn.settings.end(), run.settings.begin(), run.settings.end());
        const uint64_t budget = run.budget_device ? run.budget_device : scene_.budget_device;
        Session session =
            drawn.session_path.empty()
                ? parse_session(drawn.session_text, std::filesystem::absolute(drawn.folder), drawn.name, drawn.settings)
                : drawn.open().session;
        const std::string key = sentence(spelled(session.render.sampling), " ", spelled(session.render.paging), " ",
                                         budget, " ", session.light.occlusion.rays);
        std::unique_ptr<golden::Studio>& studio = studios_[key];
        if (!studio)
            studio = std::make_unique<golden::Studio>(
                drawn, golden::StudioOptions{.device = options_.device, .validation = false, .budget_device = budget});
        if (!drawn.session_path.empty()) session.transfer_function = studio->session().transfer_function;
        session.render.size = glm::max(glm::uvec2(glm::dvec2(session.render.size) * run.scale + 0.5), glm::uvec2(1));
        return {&run, studio.get(), std::move(session)};
    }

private:
    const Scene& scene_;
    const MeasureOptions& options_;
    std::map<std::string, std::unique_ptr<golden::Studio>> studios_;
};

Picture draw(Prepared& prepared, bool counted)
{
    return prepared.studio->picture_of(prepared.session, prepared.studio->camera(), counted);
}

/// Returns the milliseconds of a picture without preparation. If settings that differ from those of the previous run
/// required updates (leap grid, sample bits, table), draws and times the picture again.
double steady_ms(Prepared& prepared)
{
    const Picture picture = draw(prepared, false);
    if (picture.passes.size() <= prepared.passes) return picture.wall_ms;
    ++prepared.redraws;
    return draw(prepared, false).wall_ms;
}

Measured first_look(Prepared& prepared, const ImageF& reference, Pictures& pictures)
{
    const Run& run = *prepared.run;
    Measured measured{.name = run.name,
                      .family = run.family,
                      .settings = run.settings,
                      .scale = run.scale,
                      .error = {},
                      .time = {},
                      .first_ms = 0.0,
                      .work = {},
                      .device_bytes = 0,
                      .redraws = 0,
                      .on_front = false};
    const Picture first = draw(prepared, false);
    measured.first_ms = first.wall_ms;
    const ImageF whole = run.scale == 1.0 ? first.image : resized(first.image, reference.width, reference.height);
    measured.error = error_of(whole, reference);
    if (run.family == "quality") pictures.of_qualities.emplace_back(run.name, whole);
    const Picture steady = draw(prepared, true);
    prepared.passes = steady.passes.size();
    measured.work = golden::counters_of(steady);
    measured.device_bytes = prepared.studio->renderer().memory().device_bytes();
    return measured;
}

std::string words_of_volume(const VolumeInfo& info)
{
    return sentence(info.size.x, " x ", info.size.y, " x ", info.size.z, " ", name_of(info.type));
}

/// A run that is timed in rounds, which alternate between all runs.
struct Timed {
    std::string name;
    std::function<double()> draw;  ///< milliseconds
    std::vector<double> milliseconds = {};
};

/// Starts the comparison program if it can draw the same picture; otherwise adds a note with the reason.
std::unique_ptr<Peer> started_peer(const Scene& scene, const golden::Studio& studio, const MeasureOptions& options,
                                   std::vector<PeerRun>& runs, std::vector<std::string>& notes)
{
    PeerOptions asked = options.peer;
    asked.mappers.clear();
    const VolumeSource& source = *studio.opened().source;
    for (const std::string& mapper : options.peer.mappers) {
        std::optional<std::string> why = why_not_by_peer(studio.session(), source, studio.camera(), mapper);
        if (!scene.drawn.script.empty()) why = "the scene is painted";
        if (why)
            notes.push_back(sentence("VTK (", mapper, ") does not draw the same: ", *why, "."));
        else
            asked.mappers.push_back(mapper);
    }
    if (asked.mappers.empty()) return nullptr;
    if (asked.program.empty()) {
        notes.emplace_back("VTK is not measured beside: no program draws with it.");
        return nullptr;
    }
    runs = peer_runs(asked, options.quick);
    try {
        return std::make_unique<Peer>(asked, studio.session(), source, studio.camera());
    } catch (const shvr::Error& error) {
        runs.clear();
        notes.push_back(sentence("VTK is not measured beside: ", error.what(), "."));
        return nullptr;
    }
}

Measured first_look_of_peer(Peer& peer, const PeerRun& run, const ImageF& reference, Pictures& pictures)
{
    Measured measured{.name = run.name,
                      .family = run.family,
                      .settings = {sentence("VTK ", peer.version()), sentence("mapper ", run.mapper),
                                   sentence("step ", digits_of(run.step))},
                      .scale = 1.0,
                      .error = {},
                      .time = {},
                      .first_ms = peer.draw(run),
                      .work = {},
                      .device_bytes = 0,
                      .redraws = 0,
                      .on_front = false};
    const ImageF picture = peer.picture(run);
    measured.error = error_of(picture, reference);
    if (run.step == 0.5) pictures.of_peers.emplace_back(run.name, picture);
    return measured;
}

void time_in_turns(std::vector<Timed>& timed, int rounds, const std::function<void(double)>& tell)
{
    // The order alternates, so that a machine that becomes slower or faster affects all runs equally.
    for (int round = 0; round < rounds; ++round) {
        tell(double(round) / rounds);
        for (Timed& each : timed) each.milliseconds.push_back(each.draw());
        std::ranges::reverse(timed);
    }
}

/// Returns the 95 % confidence interval of the median by a deterministic bootstrap: draws many samples of the same size
/// from `sorted`, with replacement, and takes the median of each. `sorted` has at least one value.
std::pair<double, double> interval_of_median(const std::vector<double>& sorted)
{
    constexpr size_t DRAWS = 1000;
    std::mt19937 random(1);
    std::vector<double> medians, drawn(sorted.size());
    for (size_t i = 0; i < DRAWS; ++i) {
        for (double& one : drawn) one = sorted[random() % sorted.size()];
        std::ranges::sort(drawn);
        medians.push_back(0.5 * (drawn[(drawn.size() - 1) / 2] + drawn[drawn.size() / 2]));
    }
    std::ranges::sort(medians);
    return {medians[DRAWS / 40], medians[DRAWS - 1 - DRAWS / 40]};
}

std::vector<std::pair<std::string, std::string>> looked_at_environment()
{
    std::vector<std::pair<std::string, std::string>> found;
    for (char** entry = environ; *entry; ++entry) {
        const std::string text = *entry, name = text.substr(0, text.find('='));
        for (const char* start : {"LP_", "LVP_", "GALLIUM_", "GALLIVM_", "MESA_", "VK_", "SHVR_"})
            if (name.starts_with(start) && name.size() < text.size())
                found.emplace_back(name, text.substr(name.size() + 1));
    }
    std::ranges::sort(found);
    return found;
}

}  // namespace

MeasuredScene measure_scene(const Scene& scene, const MeasureOptions& options)
{
    const auto say = [&](const std::string& what, double share) {
        if (options.tell) options.tell(scene.name + ": " + what, share);
    };
    MeasuredScene measured{
        .result = {.name = scene.name, .what = scene.what, .volume = {}, .reference_seconds = 0.0, .runs = {}},
        .pictures = {}};
    std::vector<Run> runs = runs_of(scene, options.quick);
    for (Run& run : mixed_runs(options.mixed)) runs.push_back(std::move(run));
    Studios studios(scene, options);
    std::vector<Prepared> prepared;
    for (const Run& run : runs) prepared.push_back(studios.prepare(run));
    const golden::Studio& any = *prepared.front().studio;
    measured.result.volume = words_of_volume(any.opened().source->info());
    measured.pictures.reference = reference_of(any, scene, options, measured.result.reference_seconds);
    for (Prepared& each : prepared) {
        say(each.run->name, double(measured.result.runs.size()) / double(runs.size()));
        measured.result.runs.push_back(first_look(each, measured.pictures.reference, measured.pictures));
    }
    std::vector<PeerRun> peer_runs;
    const std::unique_ptr<Peer> peer = started_peer(scene, any, options, peer_runs, measured.result.notes);
    for (const PeerRun& run : peer_runs)
        measured.result.runs.push_back(first_look_of_peer(*peer, run, measured.pictures.reference, measured.pictures));

    std::vector<Timed> timed;
    for (Prepared& each : prepared) timed.push_back({each.run->name, [&each] { return steady_ms(each); }});
    for (const PeerRun& run : peer_runs) timed.push_back({run.name, [&] { return peer->draw(run); }});
    const bool by_processor = prepared.front().studio->renderer().device().traits().is_cpu;
    if (by_processor)
        timed.push_back({YARDSTICK, [] { return yardstick_ms(int(std::thread::hardware_concurrency())); }});
    time_in_turns(timed, options.rounds, [&](double share) { say("timing", share); });
    for (const Timed& each : timed)
        if (each.name == YARDSTICK)
            measured.result.yardstick = time_of(each.milliseconds);
        else
            std::ranges::find(measured.result.runs, each.name, &Measured::name)->time = time_of(each.milliseconds);
    for (size_t i = 0; i < prepared.size(); ++i) measured.result.runs[i].redraws = prepared[i].redraws;
    find_front(measured.result.runs);
    return measured;
}

Results who_measures(const std::string& device)
{
    Renderer renderer({.device = {.device = device}});
    const golden::Maker maker = golden::maker_of(renderer);
    Results results{.device = maker.device,
                    .driver = maker.driver,
                    .processor = maker.processor,
                    .instructions = maker.instructions,
                    .cores = 0,
                    .load = 0.0,
                    .rounds = 0,
                    .width = 0,
                    .height = 0,
                    .scenes = {}};
    results.environment = looked_at_environment();
    results.cores = int(std::thread::hardware_concurrency());
    double load = 0.0;
    if (::getloadavg(&load, 1) == 1) results.load = load;
    return results;
}

Error error_of(const ImageF& picture, const ImageF& reference)
{
    if (picture.width != reference.width || picture.height != reference.height)
        fail("a picture of ", picture.width, " x ", picture.height, " pixels cannot be compared with a reference of ",
             reference.width, " x ", reference.height);
    Error error;
    double squares = 0.0, alpha_squares = 0.0;
    for (size_t i = 0; i < picture.rgba.size(); ++i) {
        const bool is_alpha = i % 4 == 3;
        const double difference = double(picture.rgba[i]) - double(reference.rgba[i]);
        (is_alpha ? alpha_squares : squares) += difference * difference;
        double& most = is_alpha ? error.alpha_max_abs : error.max_abs;
        most = std::max(most, std::abs(difference));
    }
    const auto pixels = double(std::max<size_t>(picture.rgba.size() / 4, 1));
    error.rmse = std::sqrt(squares / (3.0 * pixels));
    error.alpha_rmse = std::sqrt(alpha_squares / pixels);
    const ImageDifference seen = compare(to_image8(picture), to_image8(reference));
    error.psnr_db = seen.psnr_db;
    error.ssim = seen.ssim;
    error.flip_mean = seen.flip_mean;
    error.flip_p99 = seen.flip_p99;
    error.fraction_over_1 = seen.fraction_over_1;
    error.fraction_over_4 = seen.fraction_over_4;
    return error;
}

ImageF resized(const ImageF& image, int width, int height)
{
    ImageF made{width, height, std::vector<float>(size_t(width) * size_t(height) * 4)};
    const auto at = [&](int x, int y, size_t channel) {
        x = std::clamp(x, 0, image.width - 1);
        y = std::clamp(y, 0, image.height - 1);
        return double(image.rgba[4 * (size_t(y) * size_t(image.width) + size_t(x)) + channel]);
    };
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            const double u = (x + 0.5) * image.width / width - 0.5, v = (y + 0.5) * image.height / height - 0.5;
            const int left = int(std::floor(u)), top = int(std::floor(v));
            for (size_t channel = 0; channel < 4; ++channel) {
                const double above = std::lerp(at(left, top, channel), at(left + 1, top, channel), u - left);
                const double below = std::lerp(at(left, top + 1, channel), at(left + 1, top + 1, channel), u - left);
                made.rgba[4 * (size_t(y) * size_t(width) + size_t(x)) + channel] =
                    float(std::lerp(above, below, v - top));
            }
        }
    return made;
}

Time time_of(std::vector<double> milliseconds)
{
    if (milliseconds.empty()) return {};
    std::ranges::sort(milliseconds);
    const size_t count = milliseconds.size();
    const double median = 0.5 * (milliseconds[(count - 1) / 2] + milliseconds[count / 2]);
    const auto p95 = size_t(std::ceil(0.95 * double(count))) - 1;
    const auto [low, high] = interval_of_median(milliseconds);
    return {milliseconds.front(), median, milliseconds[p95], low, high};
}

}  // namespace shvr::bench
