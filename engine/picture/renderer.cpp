#include "engine/picture/renderer.h"

#include <algorithm>
#include <cstring>
#include <utility>

#include "engine/base/machine/machine.h"
#include "engine/picture/picture_job.h"
#include "engine/volume/levels/pyramid_source.h"

namespace shvr {

namespace {

/// 2 GiB, or half of the memory that the process was given where that is less.
uint64_t automatic_host_bytes()
{
    return std::min(uint64_t{2} << 30, memory_allowed() / 2);
}

int worker_count(int wanted)
{
    return wanted > 0 ? wanted : processors_allowed();
}

}  // namespace

Renderer::Renderer(const Options& options)
    : device_options_(options.device),
      device_budget_(options.budget.device_bytes),
      host_budget_(options.budget.host_bytes > 0 ? options.budget.host_bytes : automatic_host_bytes()),
      threads_(worker_count(options.threads))
{
    restart();
}

void Renderer::restart()
{
    scene_.reset();
    const std::lock_guard lock(device_mutex_);
    on_device_.reset();
    on_device_ = std::make_unique<OnDevice>(device_options_, gpu::Budget{device_budget_, host_budget_ / 2});
}

Scene::Options Renderer::scene_options(const RenderSettings& settings, bool with_occlusion) const
{
    return {.sampling = settings.sampling,
            .paging = settings.paging,
            .with_occlusion = with_occlusion,
            .threads = threads_,
            .host_bytes = host_budget_};
}

void Renderer::check_sizes(const VolumeSource& source, const RenderSettings& settings, bool with_occlusion)
{
    Scene::check_sizes(memory(), source, scene_options(settings, with_occlusion));
}

void Renderer::load(std::shared_ptr<const VolumeSource> source, const VolumeStatistics& statistics,
                    const RenderSettings& settings, bool with_occlusion, const Progress& progress)
{
    Scene::Options options = scene_options(settings, with_occlusion);
    options.progress = progress;
    if (!Scene::fits_now(memory(), *source, options)) scene_.reset();
    scene_ = std::make_unique<Scene>(executor(), memory(), std::move(source), statistics, options);
}

std::unique_ptr<Scene> Renderer::begin_loading(std::shared_ptr<const VolumeSource> source,
                                               const VolumeStatistics& statistics, const RenderSettings& settings,
                                               bool with_occlusion, const Document& document)
{
    Scene::Options options = scene_options(settings, with_occlusion);
    options.in_slices = true;
    options.reserved_bytes = Scene::bytes_to_show(document);
    return std::make_unique<Scene>(on_device_->executor, on_device_->memory, std::move(source), statistics, options);
}

bool Renderer::fits_beside(const VolumeSource& source, const RenderSettings& settings, bool with_occlusion,
                           const Document& document)
{
    Scene::Options options = scene_options(settings, with_occlusion);
    options.reserved_bytes = Scene::bytes_to_show(document);
    return Scene::fits_now(on_device_->memory, source, options);
}

std::shared_ptr<const VolumeSource> Renderer::with_levels(std::shared_ptr<const VolumeSource> source,
                                                          const RenderSettings& settings, bool with_occlusion,
                                                          uint64_t reserved_bytes, const Progress& progress) const
{
    {
        Scene::Options options = scene_options(settings, with_occlusion);
        options.reserved_bytes = reserved_bytes;
        const std::lock_guard lock(device_mutex_);
        if (!on_device_) throw DeviceLost("the graphics device was lost and could not be started again");
        if (!Scene::pages_alone(on_device_->memory, *source, options)) return source;
    }
    return shvr::with_levels(std::move(source), host_budget_, progress);
}

SceneEstimate Renderer::estimate(const VolumeSource& source, const RenderSettings& settings, bool with_occlusion) const
{
    const std::lock_guard lock(device_mutex_);
    if (!on_device_) throw DeviceLost("the graphics device was lost and could not be started again");
    const gpu::Memory& memory = on_device_->memory;
    const AtlasCodes codes = Scene::codes_for(memory.traits(), source.info().type, settings.sampling);
    return estimate_scene(source, settings.paging, with_occlusion, memory.device_budget(), host_budget_,
                          Scene::can_be_resident(memory, source, scene_options(settings, with_occlusion)), codes,
                          Scene::most_atlas_bytes(memory.traits(), codes, with_occlusion));
}

Scene& Renderer::scene() const
{
    SHVR_CHECK(scene_ != nullptr, "no volume is loaded");
    return *scene_;
}

uint64_t Renderer::host_bytes() const
{
    const auto counts = scene_ ? scene_->volume().counts() : std::nullopt;
    return on_device_->memory.host_bytes() + (counts ? counts->host_bytes : 0) + picture_bytes_;
}

uint64_t Renderer::peak_host_bytes() const
{
    const auto counts = scene_ ? scene_->volume().counts() : std::nullopt;
    return on_device_->memory.peak_host_bytes() + (counts ? counts->peak_host_bytes : 0) + peak_picture_bytes_;
}

void Renderer::note_picture_bytes(uint64_t bytes)
{
    picture_bytes_ = bytes;
    peak_picture_bytes_ = std::max(peak_picture_bytes_, bytes);
}

Picture Renderer::render(const Session& session, const Camera& camera, const RenderOptions& options)
{
    const glm::uvec2 size = session.render.size;
    const size_t values = size_t(size.x) * size.y * 4;
    if (values * sizeof(float) > host_budget_)
        fail("render.size is ", size.x, " x ", size.y, " pixels, which take ", values * sizeof(float) >> 20,
             " MiB of memory; expected at most the host's budget, ", host_budget_ >> 20, " MiB");
    ImageF image{int(size.x), int(size.y), {}};
    image.rgba.reserve(values);
    PictureJob job(*this, session, camera, options, [&](const ImageF& rows) {
        image.rgba.insert(image.rgba.end(), rows.rgba.begin(), rows.rgba.end());
    });
    while (!job.is_done()) job.step();
    Picture picture = job.take();
    picture.image = std::move(image);
    return picture;
}

std::optional<Renderer::Seen> Renderer::pick(const Look& look, const Camera& camera, const glm::uvec2& pixels,
                                             const glm::uvec2& pixel, const std::optional<ProbeLook>& probe)
{
    FrameGraph graph;
    const PicturePart part{
        .pixels = pixels, .begin = pixel, .end = pixel + 1u, .always_shown = voxels_of_shell(probe, scene().info())};
    const uint32_t index = graph.read_back(shvr::pick(graph, scene(), look, camera, part));
    const gpu::FrameResult result = executor().run(std::move(graph), {.timestamps = false});
    glm::vec4 voxel_and_opacity;
    std::memcpy(&voxel_and_opacity, result.read_backs[index].data(), sizeof voxel_and_opacity);
    if (voxel_and_opacity.w == 0.0f) return std::nullopt;
    return Seen{glm::dvec3(voxel_and_opacity) * scene().info().spacing, voxel_and_opacity.w};
}

}  // namespace shvr
