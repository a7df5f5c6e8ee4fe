// A .mask file: the first three bytes are the sides of the volume it is for, the rest is the file.

#include "engine/annotation/files/mask_file.h"
#include "tests/fuzz/support/attempt.h"
#include "tests/fuzz/support/input_folder.h"

#include <fstream>
#include <iterator>

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size)
{
    using namespace shvr;
    using namespace shvr::fuzz;
    if (size < 3) return 0;
    const Size3 sides(1 + data[0] % 64, 1 + data[1] % 64, 1 + data[2] % 64);
    const std::string_view content = text_of({data + 3, size - 3});
    const InputFolder& folder = input_folder();
    folder.clear();
    const auto file = folder.write("a.mask", content);
    accepts([&] {
        Mask mask(sides);
        const std::vector<MaskBrickChange> changes = load_mask(file, sides);
        for (const MaskBrickChange& change : changes) mask.apply(change, Direction::forwards);
        save_mask(folder.path() / "b.mask", mask);
        std::ifstream saved(folder.path() / "b.mask", std::ios::binary);
        const std::string again{std::istreambuf_iterator<char>(saved), {}};
        expect(again == content, "a mask that is saved with other bytes than it was read from");
        for (const MaskBrickChange& change : changes) mask.apply(change, Direction::backwards);
        expect(mask.painted_bricks().empty(), "a mask that is not empty once all of it is undone");
    });
    return 0;
}
