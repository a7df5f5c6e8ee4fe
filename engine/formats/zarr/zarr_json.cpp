#include "engine/formats/zarr/zarr_json.h"

namespace shvr {

JsonDocument read_zarr_json(const std::filesystem::path& file, int64_t max_bytes)
{
    constexpr JsonLimits LIMITS{.depth = 64, .expected = "an object of metadata", .may_repeat_keys = true};
    JsonDocument document = read_json(file, max_bytes, LIMITS);
    if (!document.root().is_object()) document.root().refuse("an object");
    return document;
}

}  // namespace shvr
