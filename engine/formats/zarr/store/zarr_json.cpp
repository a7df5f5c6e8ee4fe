#include "engine/formats/zarr/store/zarr_json.h"

#include <cerrno>

#include "engine/base/file.h"

namespace shvr {

namespace {

constexpr JsonLimits LIMITS{.depth = 64, .expected = "an object of metadata", .may_repeat_keys = true};

JsonDocument of_object(JsonDocument document)
{
    if (!document.root().is_object()) document.root().refuse("an object");
    return document;
}

}  // namespace

JsonDocument read_zarr_json(const std::filesystem::path& file, int64_t max_bytes)
{
    return of_object(read_json(file, max_bytes, LIMITS));
}

JsonDocument read_zarr_json(const ZarrPlace& place, const std::string& name, int64_t max_bytes)
{
    const std::string path = place.path_of(name).string();
    const auto bytes = place.store->read(place.key(name), max_bytes);
    if (!bytes) fail(path, ": cannot be opened: ", reason_of(ENOENT));
    return of_object({std::string_view(reinterpret_cast<const char*>(bytes->data()), bytes->size()), path, LIMITS});
}

}  // namespace shvr
