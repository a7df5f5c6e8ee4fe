// The .zattrs of a label image, which describes its labels.

#include "engine/session/label_looks.h"

#include "engine/annotation/files/mask_segments.h"
#include "engine/base/error.h"
#include "engine/formats/zarr/ome_zarr_labels.h"
#include "tests/fuzz/support/attempt.h"
#include "tests/fuzz/support/input_folder.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size)
{
    using namespace shvr;
    using namespace shvr::fuzz;
    const InputFolder& folder = input_folder();
    folder.fill({data, size}, "bundles/.zattrs");
    accepts([&] {
        const LabelLooks read = read_label_looks(folder.path() / "bundles");
        for (size_t i = 1; i < read.looks.size(); ++i)
            expect(read.looks[i - 1].value < read.looks[i].value, "labels that do not ascend");
        Groups groups;
        for (const std::string& warning : take_label_looks(folder.path() / "bundles", groups))
            passes([&] { fail(warning); });
        const auto is_share = [](double value) { return value >= 0.0 && value <= 1.0; };
        for (const auto& [number, group] : groups) {
            expect(number > 0, "a look of what is not painted");
            if (group.opacity) expect(is_share(*group.opacity), "an opacity that is no share");
            if (group.color)
                for (int i = 0; i < 3; ++i) expect(is_share((*group.color)[i]), "a colour that is no light");
        }
        if (const std::optional<NrrdHead> head = mask_header(folder.path() / "bundles")) {
            std::string text;
            for (const std::string& line : lines_of(*head)) text += line + "\n";
            const std::optional<NrrdHead> again = nrrd_head_in(text);
            expect(again && segments_of(*again).size() == segments_of(*head).size(), "another header than was read");
        }
        // The groups' looks are written as they were read.
        for (const LabelImage::Color& look : label_looks(groups, Mask(Size3(1))))
            for (const LabelLook& label : read.looks)
                if (label.value == look.value && label.rgba)
                    expect(look.rgba == *label.rgba, "another colour than was read");
    });
    return 0;
}
