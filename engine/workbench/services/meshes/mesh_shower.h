#pragma once
// Keeps the scene's meshes equal to those of the session: a job reads their files, and the picture is drawn again.
// Undo, redo, a script and the panel change the session alone.

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "engine/workbench/desk/service.h"
#include "engine/workbench/models/view_model.h"

namespace shvr::ui {

class MeshShower : public Service {
public:
    /// Functions of other services that it calls.
    struct Others {
        Call<void()> look_again;
    };
    MeshShower(Desk& desk, Others others) : Service(desk), others_(std::move(others)) {}
    void advance() override;
    MeshModel model() const { return {failures_}; }

private:
    void begin_reading();

    const Others others_;
    std::vector<MeshLook> wanted_;  ///< that a job reads, or has read
    uint64_t scene_ = 0;            ///< number of the scene in which they are, or will be (Scene::number)
    std::vector<std::pair<std::string, std::string>> failures_;  ///< why meshes that were read last are not drawn
    std::weak_ptr<const Session> read_;                          ///< expires when the job has ended, or was cancelled
};

}  // namespace shvr::ui
