// Pictures that must not change unnoticed: draws every tests/golden/NAME.json and compares it with NAME.png beside it.
// Then tests the suite itself: different goldens and deliberately wrong renderings must fail. tests/golden/README.md
// says how to add a golden and how to bless one; run from the repository's root.

#include <fnmatch.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <functional>
#include <iostream>
#include <map>

#include <doctest/doctest.h>
#include <nlohmann/json.hpp>

#include "engine/annotation/script/script.h"
#include "engine/base/atomic_file.h"
#include "engine/base/file.h"
#include "engine/base/image_file.h"
#include "engine/base/image_metrics.h"
#include "engine/live/previewer.h"

using namespace shvr;
using Json = nlohmann::ordered_json;
namespace fs = std::filesystem;

namespace {

const fs::path FOLDER = "tests/golden";
constexpr int64_t MAX_FILE_BYTES = 1 << 20;
constexpr std::string_view LAVAPIPE = "llvmpipe";  // the device name that the driver lavapipe reports

struct Golden {
    std::string name, why;
    OpenedSession opened;
    std::vector<ScriptLine> script;

    fs::path picture() const { return FOLDER / (name + ".png"); }
    fs::path side_car() const { return FOLDER / (name + ".blessed.json"); }
};

/// Scripts are read from files, so the lines in a golden are written to a temporary file.
std::vector<ScriptLine> script_of(const std::string& name, const Json& lines)
{
    const fs::path path = fs::temp_directory_path() / sentence("shvr-golden-", ::getpid(), "-", name, ".jsonl");
    std::ofstream file(path);
    for (const Json& line : lines) file << line.dump() << '\n';
    file.close();
    std::vector<ScriptLine> script = read_script(path);
    fs::remove(path);
    return script;
}

Golden read_golden(const fs::path& path)
{
    Golden golden{.name = path.stem().string()};
    const Json json = Json::parse(read_text(path, MAX_FILE_BYTES));
    for (const auto& [key, value] : json.items())
        if (key != "why" && key != "class" && key != "session" && key != "script")
            fail(path, ": unknown key ", key, "; expected why, class, session and perhaps script");
    golden.why = json.at("why").get<std::string>();
    if (golden.why.empty()) fail(path, ": why is empty; expected what the picture watches over");
    if (json.at("class") != "tight") fail(path, ": class is ", json.at("class").dump(), "; expected \"tight\"");
    golden.opened.session = parse_session(json.at("session").dump(), FOLDER, path.string());
    golden.opened.source = open_source(golden.opened.session);
    golden.opened.statistics = measure(*golden.opened.source);
    if (json.contains("script")) golden.script = script_of(golden.name, json["script"]);
    return golden;
}

std::vector<Golden> all_goldens()
{
    std::vector<fs::path> paths;
    for (const fs::directory_entry& entry : fs::directory_iterator(FOLDER))
        if (entry.path().extension() == ".json" && entry.path().stem().extension() != ".blessed")
            paths.push_back(entry.path());
    std::sort(paths.begin(), paths.end());
    std::vector<Golden> goldens;
    for (const fs::path& path : paths) goldens.push_back(read_golden(path));
    return goldens;
}

/// Draws one golden, with its own renderer, so that no picture depends on earlier ones. A validation message fails the
/// test that caused it.
struct Studio {
    Renderer renderer{{.device = {.device = "", .validation = true}}};
    std::optional<Annotator> annotator;
    ~Studio()
    {
        const std::vector<std::string> messages = renderer.device().take_validation_messages();
        CHECK_MESSAGE(messages.empty(), (messages.empty() ? std::string() : messages.front()));
    }

    bool is_lavapipe() { return renderer.device().traits().name.find(LAVAPIPE) != std::string::npos; }

    explicit Studio(const Golden& golden) { set_up(golden); }

    /// Loads the volume and paints; `draw` may follow any number of times.
    void set_up(const Golden& golden)
    {
        renderer.load(golden.opened.source, golden.opened.statistics, golden.opened.session.render);
        renderer.scene().set_surfaces(golden.opened.session.surfaces);
        annotator.emplace(renderer);
        for (const ScriptLine& line : golden.script) {
            if (const auto* paint = std::get_if<PaintOp>(&line.op)) {
                if (annotator->paint(in_session(*paint, golden.opened.session)) == 0)
                    fail(golden.name, ": script line ", line.number, " paints nothing");
            } else if (const auto* undo = std::get_if<UndoOp>(&line.op)) {
                for (int i = 0; i < undo->count; ++i)
                    if (!annotator->undo()) fail(golden.name, ": script line ", line.number, ": nothing to undo");
            } else {
                fail(golden.name, ": script line ", line.number, " is neither paint nor undo");
            }
        }
    }

    Image8 draw(const Session& session, const Camera& camera)
    {
        const Picture picture =
            renderer.render(session, camera, {.probe = shown_probe(session, renderer, annotator.value())});
        REQUIRE(picture.complete);
        REQUIRE(count_not_finite(picture.image) == 0);
        return to_image8(picture.image);
    }
    Image8 draw(const Golden& golden) { return draw(golden.opened.session, camera_of_golden(golden)); }

    static Camera camera_of_golden(const Golden& golden)
    {
        return camera_named(golden.opened.session, golden.opened.session.camera_name, golden.opened.source->info());
    }
};

/// FNV-1a, 64 bits, of a file. Protects against mistakes, not against malice.
std::string hash_of(std::span<const std::byte> bytes)
{
    uint64_t hash = 0xcbf29ce484222325u;
    for (const std::byte byte : bytes) hash = (hash ^ std::to_integer<uint64_t>(byte)) * 0x100000001b3u;
    char text[17];
    std::snprintf(text, sizeof text, "%016llx", static_cast<unsigned long long>(hash));
    return text;
}

/// Why the picture and its side-car do not belong together; null if they do.
std::optional<std::string> why_not_blessed(const Golden& golden)
{
    if (!fs::exists(golden.picture())) return sentence(golden.picture().string(), " is missing");
    if (!fs::exists(golden.side_car())) return sentence(golden.side_car().string(), " is missing");
    const Json side_car = Json::parse(read_text(golden.side_car(), MAX_FILE_BYTES));
    const std::string found = hash_of(read_file(golden.picture(), MAX_FILE_BYTES));
    const std::string expected = side_car.at("fnv1a64").get<std::string>();
    if (found != expected)
        return sentence(golden.picture().string(), " has hash ", found, "; its side-car says ", expected);
    return std::nullopt;
}

std::string bless_command(const std::string& name)
{
    return sentence("tools/bless_goldens ", name, " --reason \"...\"");
}

/// $SHVR_GOLDEN_OUTPUT, or golden/ beside the test program.
fs::path output_folder()
{
    const char* chosen = std::getenv("SHVR_GOLDEN_OUTPUT");
    const fs::path folder = chosen ? fs::path(chosen) : fs::read_symlink("/proc/self/exe").parent_path() / "golden";
    fs::create_directories(folder);
    return folder;
}

/// Writes the drawn picture, the expected one, and 16 times the difference. Returns their paths.
std::string write_evidence(const Golden& golden, const Image8& actual, const Image8& expected)
{
    const fs::path start = output_folder() / golden.name;
    write_png(start.string() + ".actual.png", actual);
    write_png(start.string() + ".expected.png", expected);
    const bool same_size = actual.width == expected.width && actual.height == expected.height;
    if (same_size) write_png(start.string() + ".difference.png", difference_picture(actual, expected));
    return start.string() + (same_size ? ".{actual,expected,difference}.png" : ".{actual,expected}.png");
}

std::optional<std::string> why_different(const Image8& actual, const Image8& expected)
{
    if (actual.width != expected.width || actual.height != expected.height) return "the sizes differ";
    return why_not_within(compare_pixels(actual, expected), TIGHT_TOLERANCE);
}

// ---- Renderings that are wrong on purpose ---------------------------------------------------------------------------

struct Mutation {
    const char* name;
    std::function<void(Session&, Camera&)> apply;
};

/// Moves the eye about the upward axis through the target.
void turn(Camera& camera, double degrees)
{
    const glm::dvec3 axis = glm::normalize(camera.up), arm = camera.eye - camera.target;
    const double angle = glm::radians(degrees), cosine = std::cos(angle);
    camera.eye = camera.target + arm * cosine + glm::cross(axis, arm) * std::sin(angle) +
                 axis * glm::dot(axis, arm) * (1.0 - cosine);
}

/// Moves the middle one by 2 % of the range, and pushes along those it would pass.
void move_a_point(Session& session)
{
    const std::span<const ControlPoint> old = session.transfer_function.points();
    std::vector<ControlPoint> points(old.begin(), old.end());
    const size_t middle = points.size() / 2;
    points[middle].intensity += 0.02 * (points.back().intensity - points.front().intensity);
    for (size_t i = middle + 1; i < points.size(); ++i)
        points[i].intensity = std::max(points[i].intensity, points[middle].intensity);
    session.transfer_function = TransferFunction(std::move(points));
}

const Mutation MUTATIONS[] = {
    {"steps twice as long", [](Session& session, Camera&) { session.render.step_voxels *= 2.0; }},
    {"steps 1 % longer", [](Session& session, Camera&) { session.render.step_voxels *= 1.01; }},
    {"shading left out or put in", [](Session& session, Camera&) { session.light.shaded = !session.light.shaded; }},
    {"rays stop at an opacity of 0.9", [](Session& session, Camera&) { session.render.opacity_limit = 0.9; }},
    {"gradients fade later", [](Session& session, Camera&) { session.light.gradient_fade *= 1.25; }},
    {"0.02 more ambient light", [](Session& session, Camera&) { session.light.ambient += 0.02; }},
    {"a duller highlight", [](Session& session, Camera&) { session.light.shininess *= 0.9; }},
    {"light from another side",
     [](Session& session, Camera&) {
         session.light.direction = {0.3, 0.5, 0.9};
     }},
    {"the cut half a voxel off", [](Session& session, Camera&) { session.cut.lower += glm::dvec3(0.5); }},
    {"the camera 0.3 degrees off", [](Session&, Camera& camera) { turn(camera, 0.3); }},
    {"a view 0.5 % higher",
     [](Session&, Camera& camera) {
         camera.fov_y_degrees *= 1.005;
         camera.height *= 1.005;
     }},
    {"the near plane left out", [](Session&, Camera& camera) { camera.near_distance = 0.0; }},
    {"a point of the transfer function 2 % off", [](Session& session, Camera&) { move_a_point(session); }},
    {"the background opaque", [](Session& session, Camera&) { session.render.background.a = 1.0; }},
    {"hidden groups shown",
     [](Session& session, Camera&) {
         for (auto& [group, look] : session.groups) look.visible = true;
     }},
    {"groups forgotten", [](Session& session, Camera&) { session.groups.clear(); }},
    {"the probe left out", [](Session& session, Camera&) { session.probe.shown = false; }},
    {"surfaces half a voxel off",
     [](Session& session, Camera&) {
         for (SurfaceLook& surface : session.surfaces) surface.from.x += 0.5;
     }},
    {"surfaces a quarter of a voxel thicker",
     [](Session& session, Camera&) {
         for (SurfaceLook& surface : session.surfaces) surface.radius_to += 0.25;
     }},
};

// ---- Blessing -------------------------------------------------------------------------------------------------------

void print_row(const std::string& name, const std::string& old_hash, const std::string& new_hash,
               const std::string& max_abs, const std::string& psnr_db)
{
    std::printf("%-22s %-16s %-16s %7s %7s\n", name.c_str(), old_hash.c_str(), new_hash.c_str(), max_abs.c_str(),
                psnr_db.c_str());
}

std::string with_one_decimal(double value)
{
    char text[32];
    std::snprintf(text, sizeof text, "%.1f", value);
    return text;
}

/// The hash of the previous picture, and how far the new one is from it: for the side-car.
Json history_of(const std::string& old_hash, const Image8& before, const Image8& actual)
{
    Json history = {{"fnv1a64", old_hash}};
    if (before.width != actual.width || before.height != actual.height) return history;
    const PixelDifference change = compare_pixels(actual, before);
    history["max_abs"] = change.max_abs;
    history["psnr_db"] = change.psnr_db ? Json(*change.psnr_db) : Json(nullptr);
    history["mean_error"] = change.mean_error;
    history["fraction_over_1"] = change.fraction_over_1;
    return history;
}

/// Draws the golden and replaces its picture and side-car, unless they are up to date.
void bless(const Golden& golden, const std::string& reason)
{
    Studio studio(golden);
    const gpu::DeviceTraits& traits = studio.renderer.device().traits();
    REQUIRE_MESSAGE(studio.is_lavapipe(), "goldens are blessed on lavapipe alone; this is ", traits.name);
    const Image8 actual = studio.draw(golden);
    const std::vector<std::byte> png = encode_png(actual, golden.name);
    const std::string new_hash = hash_of(png);
    std::string old_hash = "none";
    Json history;
    if (fs::exists(golden.picture())) {
        old_hash = hash_of(read_file(golden.picture(), MAX_FILE_BYTES));
        const Image8 before = read_png(golden.picture());
        if (before == actual && !why_not_blessed(golden)) return print_row(golden.name, old_hash, "unchanged", "0", "");
        history = history_of(old_hash, before, actual);
    }
    const Json side_car = {{"reason", reason},
                           {"device", traits.name},
                           {"driver", traits.driver},
                           {"fnv1a64", new_hash},
                           {"previous", history}};
    const std::string text = side_car.dump(2) + "\n";
    write_file_atomically(golden.picture(), png);
    write_file_atomically(golden.side_car(), std::as_bytes(std::span(text)));
    const bool measured = history.contains("max_abs");
    const bool differs = measured && !history["psnr_db"].is_null();
    print_row(golden.name, old_hash, new_hash, measured ? with_one_decimal(history["max_abs"]) : "-",
              differs ? with_one_decimal(history["psnr_db"]) : "-");
}

}  // namespace

TEST_CASE("every golden is drawn as it was blessed")
{
    const std::vector<Golden> goldens = all_goldens();
    REQUIRE_MESSAGE(!goldens.empty(), FOLDER.string(), " holds no golden");
    for (const Golden& golden : goldens) {
        CAPTURE(golden.name);
        const std::optional<std::string> not_blessed = why_not_blessed(golden);
        if (not_blessed) {
            FAIL_CHECK(*not_blessed << "; to bless it: " << bless_command(golden.name));
            continue;
        }
        Studio studio(golden);
        const Image8 actual = studio.draw(golden), expected = read_png(golden.picture());
        const std::optional<std::string> why = why_different(actual, expected);
        if (!why) continue;
        const std::string report =
            sentence(golden.name, " (", golden.why, "): ", *why, "\n  see ", write_evidence(golden, actual, expected),
                     "\n  if it is meant: ", bless_command(golden.name));
        if (studio.is_lavapipe())
            FAIL_CHECK(report);
        else  // rounding may differ by more than "tight" allows
            MESSAGE(studio.renderer.device().traits().name << ": " << report);
    }
}

TEST_CASE("no picture without a golden, and no golden like another")
{
    const std::vector<Golden> goldens = all_goldens();
    for (const fs::directory_entry& entry : fs::directory_iterator(FOLDER)) {
        const std::string file = entry.path().filename().string();
        const std::string name = file.substr(0, file.find('.'));
        const bool known = std::any_of(goldens.begin(), goldens.end(), [&](const Golden& g) { return g.name == name; });
        CHECK_MESSAGE((known || file == "README.md"), entry.path().string(), " belongs to no golden");
    }
    std::vector<Image8> pictures;
    for (const Golden& golden : goldens) pictures.push_back(read_png(golden.picture()));
    for (size_t a = 0; a < goldens.size(); ++a)
        for (size_t b = a + 1; b < goldens.size(); ++b)
            CHECK_MESSAGE(why_different(pictures[a], pictures[b]), goldens[a].name, " passes for ", goldens[b].name);
}

TEST_CASE("a golden is drawn with the same bits twice, loaded anew, and without leaps")
{
    for (const Golden& golden : all_goldens()) {
        CAPTURE(golden.name);
        const Camera camera = Studio::camera_of_golden(golden);
        Studio studio(golden);
        const ImageF once = studio.renderer.render(golden.opened.session, camera).image;
        CHECK_MESSAGE(studio.renderer.render(golden.opened.session, camera).image == once, "drawn twice");
        Session walking = golden.opened.session;
        walking.render.skip_empty_space = false;
        CHECK_MESSAGE(studio.renderer.render(walking, camera).image == once, "without leaps");
        studio.set_up(golden);
        CHECK_MESSAGE(studio.renderer.render(golden.opened.session, camera).image == once, "loaded anew");
    }
}

TEST_CASE("every wrong rendering fails a golden")
{
    std::map<std::string, std::vector<std::string>> caught_by;
    for (const Golden& golden : all_goldens()) {
        const Image8 expected = read_png(golden.picture());
        Studio studio(golden);
        if (why_different(studio.draw(golden), expected)) continue;  // it fails unchanged, so it proves nothing here
        for (const Mutation& mutation : MUTATIONS) {
            Session session = golden.opened.session;
            Camera camera = Studio::camera_of_golden(golden);
            mutation.apply(session, camera);
            studio.renderer.scene().set_surfaces(session.surfaces);
            if (why_different(studio.draw(session, camera), expected)) caught_by[mutation.name].push_back(golden.name);
        }
    }
    for (const Mutation& mutation : MUTATIONS) {
        const std::vector<std::string>& names = caught_by[mutation.name];
        INFO(mutation.name);
        CHECK(!names.empty());
        if (std::getenv("SHVR_GOLDEN_VERBOSE")) {
            std::cout << mutation.name << ": caught by " << names.size() << ":";
            for (const std::string& name : names) std::cout << ' ' << name;
            std::cout << '\n';
        }
    }
}

// Skipped unless tools/bless_goldens runs it, which sets the two variables.
TEST_CASE("blessing goldens" * doctest::skip())
{
    const char* reason = std::getenv("SHVR_BLESS_REASON");
    const char* pattern = std::getenv("SHVR_BLESS_PATTERN");
    REQUIRE_MESSAGE((reason && *reason && pattern), "use tools/bless_goldens");
    int matched = 0;
    print_row("golden", "old", "new", "max_abs", "psnr_db");
    for (const Golden& golden : all_goldens()) {
        if (::fnmatch(pattern, golden.name.c_str(), 0) != 0) continue;
        ++matched;
        bless(golden, reason);
    }
    REQUIRE_MESSAGE(matched > 0, "no golden is named ", std::string(pattern));
}
