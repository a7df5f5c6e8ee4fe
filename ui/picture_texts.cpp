#include "ui/picture_texts.h"

#include "ui/panels/style.h"

namespace shvr::ui {

std::vector<TextImage> draw_picture_texts(std::span<const std::string> texts, double pixels)
{
    return draw_texts(texts, pixels);
}

}  // namespace shvr::ui
