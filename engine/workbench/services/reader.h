#pragma once
// Reads the values under the probe and the pointer, keeps measurements, and reports the scene's messages.

#include "engine/live/far_voxels.h"
#include "engine/workbench/desk/preference_keeper.h"
#include "engine/workbench/desk/service.h"

namespace shvr::ui {

class Reader : public Service {
public:
    /// Functions of other services that it calls.
    struct Others {
        Call<std::optional<Pointer>()> pointer;
        Call<Pane(size_t index)> pane;
        Call<std::optional<glm::dvec3>(const Pane&, const glm::dvec2& pixel)> seen_at;
        Call<void(Session)> take_session;
    };
    Reader(Desk& desk, PreferenceKeeper& keeper, Others others);
    void act(const MeasureAt& action);
    void act(const EndMeasure& action);
    void act(const TakeBackPoint& action);
    void act(const RenameMeasurement& action);
    void act(const RemoveMeasurement& action);
    void act(const ClearMeasurements& action);
    void act(const CopyMeasurements& action);

    void advance() override;
    /// Discards the value that was read last, since it belongs to the previous document.
    void begin_document() { read_voxel_.reset(); }
    /// Returns the text to copy to the clipboard, and clears it; empty: there has been no text since the last call.
    std::string take_clipboard() { return std::exchange(clipboard_, {}); }
    ReadingModel model() const;

private:
    void follow_reading();
    void complete_measurement();
    bool read_at(const glm::dvec3& voxel);
    bool probe_is_measured() const;
    glm::dvec3 voxel_to_read() const;

    PreferenceKeeper& keeper_;
    const Others others_;
    Reading reading_;
    std::optional<glm::dvec3> read_voxel_;  ///< voxel, in whole coordinates, that has the intensity in `reading_`
    uint64_t read_revision_ = 0;            ///< revision of the paint
    FarVoxels far_;                         ///< the voxel, if the volume is on another machine
    double read_again_s_ = 0.0;             ///< earliest time of the next read, which limits the time spent reading
    std::string clipboard_;
    Attempt reading_turn_;
};

}  // namespace shvr::ui
