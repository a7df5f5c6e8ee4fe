#pragma once
// What is drawn over a figure, as one more text of its file beside the session (engine/session/picture_session.h), from
// which it is drawn again. One line of JSON:
//
//   "SHVR figure"    {"shvr_figure": 1, "scale_bar": true, ..., "title": "Bellis", "texts": [{"voxel": [40, 52.5, 7],
//                    "text": "stem"}], "text_pixels": 20}; absent if nothing is drawn over the picture
//
// Any thread.

#include <filesystem>
#include <optional>

#include "engine/base/image_file.h"
#include "engine/workbench/actions/picture_actions.h"

namespace shvr::ui {

/// Adds the elements to the texts of a picture, if there are any. Fails for elements that could not be read again, such
/// as more than MAX_FIGURE_TEXTS texts or 64 KiB.
void add_elements(PictureTexts& texts, const DrawnElements& elements);
/// Returns the elements that the file of a picture states; null if it states none, or is no picture. Fails if they are
/// not as expected.
std::optional<DrawnElements> elements_in_picture(const std::filesystem::path& picture);

}  // namespace shvr::ui
