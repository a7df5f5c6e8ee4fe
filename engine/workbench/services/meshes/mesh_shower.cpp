#include "engine/workbench/services/meshes/mesh_shower.h"

#include "engine/session/meshes/session_meshes.h"

namespace shvr::ui {

void MeshShower::advance()
{
    if (!read_.expired()) return;
    const bool is_same_scene = scene_ == renderer_.scene().number();
    const std::vector<MeshLook>& meshes = document_->session.meshes;
    if (is_same_scene && wanted_ == meshes) return;
    const bool has_none = meshes.empty() && (!is_same_scene || wanted_.empty());
    wanted_ = meshes;
    scene_ = renderer_.scene().number();
    failures_.clear();
    if (!has_none) begin_reading();
}

void MeshShower::begin_reading()
{
    const auto session = std::make_shared<const Session>(document_->session);
    read_ = session;
    const auto reading = [this, session, volume = document_->volume(), scene = scene_,
                          memory = renderer_.host_budget()](ProgressReporter& reporter) -> Jobs::Completion {
        const auto read =
            std::make_shared<ReadMeshes>(read_meshes(*session, volume, memory, reporter.begin("reading meshes")));
        return [this, read, scene] {
            if (!document_ || renderer_.scene().number() != scene) return;
            for (const auto& [file, failure] : read->failures) say(failure, Weight::error);
            failures_ = std::move(read->failures);
            for (const std::string& warning : read->warnings) say(warning, Weight::warning);
            try {
                renderer_.scene().show_meshes(std::move(read->tree));
            } catch (const gpu::MemoryError& error) {
                say(sentence("The meshes are not drawn: ", error.what()), Weight::error);
            }
            others_.look_again();
        };
    };
    jobs_.start("reading meshes", reading);
}

}  // namespace shvr::ui
