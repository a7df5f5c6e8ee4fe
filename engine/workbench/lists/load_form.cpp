#include "engine/workbench/lists/load_form.h"

#include "engine/base/error.h"
#include "engine/volume/unit.h"

namespace shvr::ui {

std::string settings_of(const LoadForm& form)
{
    std::string lines;
    const auto add = [&](const auto&... parts) { lines += sentence(lines.empty() ? "" : "\n", parts...); };
    if (form.is_bare)
        add("volume.raw=", form.size[0], "x", form.size[1], "x", form.size[2], ":", name_of(form.type),
            form.is_big_endian ? ":big:" : ":little:", form.offset_bytes);
    if (!form.is_bare && !form.channel.empty()) add("volume.channel=", form.channel);
    if (!form.is_bare && !form.frame.empty()) add("volume.frame=", form.frame);
    if (!form.is_bare && form.level > 0) add("volume.level=", form.level);
    if (form.states_spacing) add("volume.spacing=[", form.spacing.x, ",", form.spacing.y, ",", form.spacing.z, "]");
    if (form.states_spacing && !form.unit.empty()) add("volume.unit=", form.unit);
    return lines;
}

std::string size_in_words(const VolumeInfo& volume)
{
    const Size3& size = volume.size;
    return sentence(size.x, " x ", size.y, " x ", size.z, " voxels of ", name_of(volume.type), ", each ",
                    spacing_in_words(volume.spacing, volume.unit));
}

const char* in_words(Provenance provenance)
{
    switch (provenance) {
        case Provenance::file: return "stated by the file";
        case Provenance::given: return "typed";
        case Provenance::assumed: return "assumed: the file states none";
    }
    return "";
}

}  // namespace shvr::ui
