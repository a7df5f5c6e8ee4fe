// The tables of a project's shvr/ folder, and its record. The first bytes select the table and the expected number of
// elements.

#include <algorithm>

#include "engine/formats/zarr/project.h"
#include "tests/fuzz/support/attempt.h"
#include "tests/fuzz/support/input_folder.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size)
{
    using namespace shvr;
    using namespace shvr::fuzz;
    const InputFolder& folder = input_folder();
    folder.clear();
    const auto file = folder.write("table", text_of({data, size}));
    if (text_of({data, size}).starts_with("{")) {
        ProjectRecord record;
        if (!accepts([&] { record = read_project_record(file); })) return 0;
        const std::string text = to_text(record);
        folder.write("again", text);
        expect(
            passes([&] { expect(to_text(read_project_record(folder.path() / "again")) == text, "a changed record"); }),
            "a record that cannot be read again");
        return 0;
    }
    // Read as the table of a volume of 2 x 2 x 1 bricks of uint8.
    ProjectTable table;
    if (accepts([&] { table = read_project_table(file, {"ranges", 0, 2, Size3(2, 2, 1)}); })) {
        expect(table.elements.size() == (table.is_sparse ? 2 * (table.keys.size() + 1) : 8), "a table of another size");
        for (int64_t brick = 0; brick < 4; ++brick) expect(table.at(brick).size() == 2, "an element of another size");
    }
    return 0;
}
