#pragma once
// Messages about changed settings. Pure; any thread.

#include <string>

#include "engine/session/session.h"

namespace shvr::ui {

/// Intensities in messages: whole numbers where the file's voxels are integers of many values, as in panels, although
/// automatic thresholds and points of transfer functions may lie between these.
class IntensityWords {
public:
    IntensityWords(VoxelType type, const ValueRange& range);
    std::string operator()(double intensity) const;
    /// Returns the session with the intensities of thresholds and slices as they are said.
    Session said(Session session) const;

private:
    double said(double intensity) const;
    bool are_whole_;
};

/// Returns a sentence about a change of settings; empty if nothing differs.
std::string change_in_words(const Session& was, const Session& is, const IntensityWords& intensity);

}  // namespace shvr::ui
