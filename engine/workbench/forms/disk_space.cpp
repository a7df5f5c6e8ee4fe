#include "engine/workbench/forms/disk_space.h"

#include "engine/base/error.h"
#include "engine/workbench/forms/form_names.h"

namespace shvr::ui {

SpaceWords words_of_space(const BytesNeeded& needed, std::optional<double> free_bytes)
{
    if (!free_bytes || needed.most <= *free_bytes) return {};
    const std::string left = bytes_in_words(*free_bytes) + " are free on that disk";
    if (needed.least > *free_bytes)
        return {.refusal = sentence("This takes at least ", bytes_in_words(needed.least), ", and ", left,
                                    ": free some space, or choose another folder."),
                .warning = {}};
    return {.refusal = {},
            .warning = sentence("This may take up to ", bytes_in_words(needed.most), ", and only ", left, ".")};
}

}  // namespace shvr::ui
