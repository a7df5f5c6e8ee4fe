// A .offset file: the first three bytes are the sides of the volume it is for, the fourth says its type, the rest is
// the file.

#include "engine/annotation/files/offset_export.h"
#include "engine/annotation/files/offset_file.h"
#include "engine/annotation/files/offset_import.h"
#include "engine/formats/open_volume.h"
#include "tests/fuzz/support/attempt.h"
#include "tests/fuzz/support/input_folder.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size)
{
    using namespace shvr;
    using namespace shvr::fuzz;
    if (size < 4) return 0;
    const Size3 sides(1 + data[0] % 64, 1 + data[1] % 64, 1 + data[2] % 64);
    const VoxelType type = VOXEL_TYPES[data[3] % std::size(VOXEL_TYPES)];
    const InputFolder& folder = input_folder();
    folder.clear();
    const auto file = folder.write("a.offset", text_of({data + 4, size - 4}));
    accepts([&] {
        const DensityField field = load_offsets(file, sides, type);
        save_offsets(folder.path() / "b.offset", field);
        const DensityField again = load_offsets(folder.path() / "b.offset", sides, type);
        expect(again.painted_bricks() == field.painted_bricks() && again.voxels() == field.voxels(),
               "offsets that are not those that were saved");
        for (const int64_t brick : field.painted_bricks())
            expect(*again.brick(brick) == *field.brick(brick), "a brick of offsets that is not the one that was saved");
        export_offsets(folder.path() / "b.nrrd", field, {.size = sides});
        expect(open_volume(folder.path() / "b.nrrd")->info().size == sides, "offsets of another size");
        const DensityField imported = import_offsets(folder.path() / "b.nrrd", {.size = sides}, type);
        expect(imported.voxels() == field.voxels(), "offsets that come back from a volume as others");
        for (const int64_t brick : imported.painted_bricks())
            expect(*imported.brick(brick) == *field.brick(brick), "a brick of offsets that comes back as another");
    });
    return 0;
}
