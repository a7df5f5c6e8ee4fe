#include "engine/device/scene_estimate.h"

#include <algorithm>
#include <cmath>

#include "engine/base/error.h"
#include "engine/device/scene.h"
#include "engine/volume/levels/pyramid_source.h"

namespace shvr {

namespace {

/// Host memory for the transfer of a resident volume: a few uploads of 5 MiB.
constexpr uint64_t TRANSFER_BYTES = uint64_t{25} << 20;

/// "312 MiB", "4.5 GiB"
std::string size_text(uint64_t bytes)
{
    const double mebibytes = std::ceil(double(bytes) / double(1 << 20));
    return mebibytes < 1024.0 ? sentence(mebibytes, " MiB") : sentence(std::round(mebibytes / 102.4) / 10.0, " GiB");
}

}  // namespace

SceneEstimate estimate_scene(const VolumeSource& source, Paging paging, bool with_occlusion, uint64_t device_budget,
                             uint64_t host_budget, bool can_be_resident, AtlasCodes codes, uint64_t most_atlas_bytes)
{
    SceneEstimate estimate{.device_budget = device_budget, .host_budget = host_budget};
    const uint64_t all = Scene::resident_bytes(source.info(), codes, with_occlusion);
    estimate.is_paged =
        paging == Paging::always ||
        (paging == Paging::automatic && (!can_be_resident || source.levels() > 1 || all > device_budget / 16 * 15));
    if (!estimate.is_paged) {
        estimate.device_bytes = all;
        estimate.host_bytes = TRANSFER_BYTES;
        if (all > device_budget)
            estimate.refusal = sentence("its bricks take ", size_text(all), " of device memory; expected at most ",
                                        size_text(device_budget), ", or render.paging automatic");
        return estimate;
    }
    // All coarser levels together take a third of the finest level. The atlas never exceeds its share.
    estimate.device_bytes =
        std::min({all / 3 * 4, Scene::atlas_share(device_budget, with_occlusion), most_atlas_bytes});
    const uint64_t levels = bytes_of_levels(source);
    estimate.makes_levels = levels > 0;
    estimate.host_bytes = std::min(all, host_budget / 4) + levels;
    try {
        static_cast<void>(planned_levels(source, host_budget));
    } catch (const Error& error) {
        estimate.refusal = error.what();
    }
    return estimate;
}

std::string in_words(const SceneEstimate& estimate)
{
    std::string text =
        sentence(size_text(estimate.device_bytes), " of ", size_text(estimate.device_budget), " on the device, ",
                 size_text(estimate.host_bytes), " of ", size_text(estimate.host_budget), " on the host");
    if (estimate.is_paged) text += "; in pieces, as fine as the view needs";
    if (estimate.makes_levels) text += "; coarser levels are made at each opening, which an import makes once";
    return text;
}

}  // namespace shvr
