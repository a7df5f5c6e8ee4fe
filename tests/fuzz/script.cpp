// Annotation scripts.

#include <cmath>

#include "engine/annotation/script/script.h"
#include "tests/fuzz/support/attempt.h"
#include "tests/fuzz/support/input_folder.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size)
{
    using namespace shvr;
    using namespace shvr::fuzz;
    const InputFolder& folder = input_folder();
    folder.clear();
    const auto file = folder.write("a.jsonl", fuzz::text_of({data, size}));
    accepts([&] {
        for (const ScriptLine& line : read_script(file)) {
            const auto* const paint = std::get_if<PaintOp>(&line.op);
            if (paint == nullptr) continue;
            expect(!paint->path.empty() && std::isfinite(paint->threshold), "a stroke without path or threshold");
            expect(paint->radius_voxels > 0.0 && paint->radius_voxels <= 128.0, "a brush without a sound radius");
            passes([&] { stroke_positions(paint->path); });
            passes([&] { check_radius(paint->radius_voxels, glm::dvec3(1.0), Size3(64)); });
        }
    });
    return 0;
}
