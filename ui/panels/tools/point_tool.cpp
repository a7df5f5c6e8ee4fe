#include "ui/panels/tools/point_tool.h"

namespace shvr::ui {

PointTool& point_tool()
{
    static PointTool tool;
    return tool;
}

}  // namespace shvr::ui
