// Pictures that must not change unnoticed: tests/golden, by the code of `shvr golden` (tools/golden). Then the suite
// itself is put to the test: different goldens, deliberately wrong renderings and wrong kernels must fail. Run from the
// repository's root.

#include <cstdlib>
#include <functional>
#include <iostream>
#include <map>
#include <set>

#include <doctest/doctest.h>

#include "engine/base/error.h"
#include "engine/base/file.h"
#include "engine/base/image_file.h"
#include "engine/base/json.h"
#include "tests/gpu/matrix/wrong_renderings.h"
#include "tests/gpu/wrong_kernels.h"
#include "tools/golden/run.h"

using namespace shvr;
using namespace shvr::test;
using golden::Golden;
using golden::Studio;
namespace fs = std::filesystem;

namespace {

const fs::path FOLDER = "tests/golden";

/// $SHVR_GOLDEN_OUTPUT, or golden/ in the folder of the test program.
fs::path output_folder()
{
    const char* chosen = std::getenv("SHVR_GOLDEN_OUTPUT");
    return chosen ? fs::path(chosen) : fs::read_symlink("/proc/self/exe").parent_path() / "golden";
}

std::optional<std::string> why_different(const Image8& actual, const Golden& golden)
{
    return golden::why_different(actual, read_png(golden.picture()), golden.strictness);
}

/// Made of the kernels' own source, one line of which is wrong.
const Mistake MISTAKES[] = {
    {"samples at the front of a step", "step_coarse", "library/lattice.glsl",
     "return begin + (float(step) + 0.5) * params.step;", "return begin + float(step) * params.step;"},
    {"the half vector not normalised", "tubes_opaque", "library/shade.glsl", "sum / sum_length", "0.5 * sum"},
    {"normals that point inwards", "tubes_opaque", "library/shade.glsl", "-slope * inversesqrt", "slope * inversesqrt"},
    {"no fading of faint gradients", "tubes_translucent", "library/shade.glsl", "square / (square + fade)", "1.0"},
    {"the last, shorter step as opaque as a whole one", "step_coarse", "rays/march.glsl", "march.rest, lattice.part)",
     "march.rest, 1.0)"},
    {"a last, shorter step between two densities as if it were whole", "preintegrated", "rays/march.glsl",
     "is_rest ? lattice.part : 1.0", "1.0"},
    {"a search that passes what it has found", "tubes_opaque", "library/search.glsl",
     "is_seen ? next :", "is_seen ? next + 1u :"},
    {"a sample whose bit is its neighbour's", "tubes_opaque", "library/search.glsl",
     "(sample_position(params, ray, begin, i) + 0.5) * parts",
     "(sample_position(params, ray, begin, i) + vec3(1.5, 0.5, 0.5)) * parts"},
    {"bits of rows that are not above what is seen alone", "tubes_opaque", "bricks/sample_bits.comp",
     "uint(code >= params.lower)", "uint(code > params.upper)"},
    {"the last, shorter step left out", "step_coarse", "rays/march.glsl", "if (march.has_rest)", "if (false)"},
    {"what is in front hides nothing", "fog_unshaded", "rays/march.glsl", "(1.0 - sum.a) * look.a;\n    sum.rgb",
     "look.a;\n    sum.rgb"},
    {"x and y exchanged between voxels", "marschner_lobb", "library/density_exact.glsl",
     "bilinear(d.v[0], d.v[1], d.v[2], d.v[3], d.fraction.x, d.fraction.y);",
     "bilinear(d.v[0], d.v[1], d.v[2], d.v[3], d.fraction.y, d.fraction.x);"},
    {"the nearer slice alone", "marschner_lobb", "library/density_exact.glsl",
     "return low + (high - low) * d.fraction.z;", "return low;"},
    {"a gradient of the wrong neighbour", "tubes_opaque", "library/density_exact.glsl",
     "f < 0.5 ? low - beyond : beyond - high", "f < 0.5 ? beyond - high : low - beyond"},
    {"gradients in voxels, not in space", "tubes_anisotropic", "library/sample.glsl", "slope * params.inverse_spacing",
     "slope"},
    {"a volume's border forgotten", "tubes_opaque", "library/atlas.glsl", "return ivec3(code_border());",
     "return ivec3(0);"},
    {"leaps that go a step too far", "tubes_translucent", "rays/march.glsl", "exit / params.step - 0.01",
     "exit / params.step + 3.0"},
    {"cells that are skipped although something shows in them", "tubes_translucent", "library/occupancy.glsl",
     "upper = float(range >> 16)", "upper = float(range & 0xffffu)"},
    {"a picture half a pixel off", "tubes_opaque", "rays/ray.glsl", "const vec2 centre = vec2(pixel) + 0.5;",
     "const vec2 centre = vec2(pixel);"},
    {"rays that go through surfaces", "surfaces", "rays/raycast.glsl",
     "span.end = min(span.end, max(surface.a, span.begin));", ""},
    {"eyes exchanged", "anaglyph", "picture/anaglyph.comp", "vec4(red.r, rest.gb,", "vec4(rest.r, red.gb,"},
    {"ambient occlusion that is too strong", "tubes_occluded", "occlusion/occlusion.glsl",
     "1.0 - occlusion_look.data.strength * (1.0 - curved)", "1.0 - (1.0 - curved)"},
    {"ambient occlusion of the next voxel", "tubes_occluded", "occlusion/occlusion.glsl",
     "int_of_whole(corner) + to_values;", "int_of_whole(corner) + to_values + 1;"},
    {"the back of a step taken for its front", "preintegrated", "library/lattice.glsl",
     "step_begin(params, lattice.begin, step + 1u)", "step_begin(params, lattice.begin, step)"},
    {"a highlight on the dark side", "surfaces", "library/shade.glsl", "facing > 0.0 ? surface",
     "facing < 0.5 ? surface"},
};

/// Names of the kernels of all passes in the golden's picture.
std::set<std::string> kernels_of(const Golden& one)
{
    Studio studio(one);
    std::set<std::string> kernels;
    for (const gpu::PassReport& pass : studio.draw_counted().passes)
        if (!pass.kernel.empty()) kernels.insert(pass.kernel);
    return kernels;
}

}  // namespace

TEST_CASE("every golden is drawn as it was blessed")
{
    golden::set_environment();
    const golden::Outcome outcome = golden::run_all(golden::goldens_in(FOLDER), output_folder(), {.validation = true});
    for (const golden::Result& result : outcome.results)
        CHECK_MESSAGE(!golden::is_failure(result.status), result.golden.name, " (", result.golden.why,
                      "): ", result.reason, "\n  see ", outcome.report.string(),
                      "\n  if it is meant: ", golden::bless_command(result.golden));
}

TEST_CASE("no picture without a golden, and no golden like another")
{
    const std::vector<Golden> goldens = golden::goldens_in(FOLDER);
    for (const fs::directory_entry& entry : fs::directory_iterator(FOLDER)) {
        const std::string file = entry.path().filename().string();
        const std::string name = file.substr(0, file.find('.'));
        const bool known = std::any_of(goldens.begin(), goldens.end(), [&](const Golden& g) { return g.name == name; });
        CHECK_MESSAGE((known || file.ends_with(".md")), entry.path().string(), " belongs to no golden");
    }
    std::vector<Image8> pictures;
    for (const Golden& each : goldens) pictures.push_back(read_png(each.picture()));
    for (size_t a = 0; a < goldens.size(); ++a)
        for (size_t b = a + 1; b < goldens.size(); ++b)
            for (const auto strictness : {goldens[a].strictness, goldens[b].strictness})
                CHECK_MESSAGE(golden::why_different(pictures[a], pictures[b], strictness), goldens[a].name,
                              " passes for ", goldens[b].name);
}

TEST_CASE("a golden is drawn with the same bits twice, loaded anew, and without leaps")
{
    for (const Golden& one : golden::goldens_in(FOLDER)) {
        CAPTURE(one.name);
        Studio studio(one, {.validation = true});
        const Camera camera = studio.camera();
        Session session = studio.session();
        session.render.size /= 2u;
        const ImageF once = studio.renderer().render(session, camera).image;
        CHECK_MESSAGE(studio.renderer().render(session, camera).image == once, "drawn twice");
        Session walking = session;
        walking.render.skip_empty_space = false;
        CHECK_MESSAGE(studio.renderer().render(walking, camera).image == once, "without leaps");
        studio.set_up();
        CHECK_MESSAGE(studio.renderer().render(session, camera).image == once, "loaded anew");
        CHECK(studio.take_validation_messages().empty());
    }
}

TEST_CASE("every wrong rendering fails the golden that it names")
{
    std::map<std::string, std::vector<const Mutation*>> mutations;
    for (const Mutation& mutation : MUTATIONS) mutations[mutation.golden].push_back(&mutation);
    for (const auto& [name, of_it] : mutations) {
        CAPTURE(name);
        const Golden one = golden::read_golden(FOLDER / (name + ".json"));
        const Image8 blessed = read_png(one.picture());
        Studio studio(one);
        CHECK_FALSE(golden::why_different(studio.draw(), blessed, one.strictness));
        for (const Mutation* mutation : of_it)
            CHECK_MESSAGE(why_noticed(*mutation, one, studio, blessed), std::string(mutation->name));
    }
}

TEST_CASE("every kernel with a mistake fails a golden")
{
    golden::set_environment();
    std::map<std::string, std::vector<std::string>> kernels;
    size_t caught = 0;
    for (const Mistake& mistake : MISTAKES) {
        CAPTURE(std::string(mistake.name));
        const Golden one = golden::read_golden(FOLDER / (std::string(mistake.golden) + ".json"));
        if (!kernels.contains(one.name)) {
            const std::set<std::string> of_it = kernels_of(one);
            kernels[one.name] = {of_it.begin(), of_it.end()};
        }
        const WrongKernels wrong(mistake, kernels[one.name]);
        CHECK_MESSAGE(wrong.count() > 0, "no kernel of ", one.name, " has the mistake");
        std::optional<std::string> why;
        try {
            why = why_different(Studio(one).draw(), one);
        } catch (const Error& error) {
            why = error.what();  // pixels that nothing draws hold what was in the memory, which may be NaN
            CHECK(why->find("values of the picture are no numbers") != std::string::npos);
        }
        CHECK_MESSAGE(why, std::string(mistake.golden), " does not notice");
        caught += why ? 1 : 0;
        if (std::getenv("SHVR_GOLDEN_VERBOSE") && why) std::cout << mistake.name << ": " << *why << '\n';
    }
    CHECK(caught >= 16);
}

TEST_CASE("a lost skip, an extra fetch and a redundant pass fail by their work, not by their picture")
{
    golden::set_environment();
    const Golden one = golden::read_golden(FOLDER / "tubes_opaque.json");
    Studio studio(one);
    golden::Drawn right = golden::drawn_by(studio);
    REQUIRE(right.work_is_exact);
    CHECK(golden::why_other_work(one, right) == std::nullopt);
    // Work is compared on processors and drivers like those of the record, which this machine's may not be.
    const JsonDocument record(read_text(one.side_car(), int64_t{1} << 20), one.side_car().string());
    const auto why_other_work = [&](golden::Drawn drawn) {
        drawn.maker.instructions = record.root()["instructions"].text();
        drawn.maker.driver = record.root()["driver"].text();
        return golden::why_other_work(one, drawn).value_or("");
    };

    Golden walking = one;  // the same picture, without leaps
    walking.session_text.insert(walking.session_text.find("\"render\":{") + 10, "\"skip_empty_space\":false,");
    Studio slow(walking);
    const golden::Drawn lost_skip = golden::drawn_by(slow);
    CHECK(lost_skip.image == right.image);
    CHECK(why_other_work(lost_skip).find("samples") != std::string::npos);

    const Mistake twice = {"a row of texels read twice", "tubes_opaque", "library/density_exact.glsl",
                           "    return d;\n}\n\n// The codes at the corner",
                           "    load_row(d, 3, corner.y + 1, corner.z + 1);\n"
                           "    return d;\n}\n\n// The codes at the corner"};
    {
        const std::set<std::string> kernels = kernels_of(one);
        const WrongKernels wrong(twice, std::vector<std::string>(kernels.begin(), kernels.end()));
        Studio wasteful(one);
        const golden::Drawn extra_fetch = golden::drawn_by(wasteful);
        CHECK(extra_fetch.image == right.image);
        CHECK(why_other_work(extra_fetch).find("density_reads") != std::string::npos);
    }

    // A ball out of view: its passes are wasted work.
    Golden needless = one;
    needless.session_text.insert(1,
                                 "\"surfaces\":[{\"from\":[-9000,-9000,-9000],\"radius\":1,\"color\":\"#ff0000\"}],");
    Studio drawing_more(needless);
    golden::Drawn redundant_pass = golden::drawn_by(drawing_more);
    CHECK(redundant_pass.image == right.image);
    CHECK(why_other_work(redundant_pass).find("passes") != std::string::npos);

    for (auto& [name, value] : right.work) value += name == "passes" ? 1 : 0;
    CHECK(why_other_work(right).find("passes") != std::string::npos);
    right.maker.instructions = "another processor's";
    CHECK(golden::why_other_work(one, right) == std::nullopt);
}
