#include "engine/annotation/stroke_result.h"

#include <doctest/doctest.h>

using namespace shvr;

namespace {

std::string known_name(uint8_t group)
{
    return group == 1 ? "aorta" : group == 3 ? "leaf trace" : group == 4 ? "" : "group " + std::to_string(group);
}

PaintOp in_group(uint8_t group)
{
    return {.group = group};
}

}  // namespace

TEST_CASE("a stroke says from which groups it took voxels, and which stayed")
{
    struct Case {
        StrokeResult result;
        const char* words;
    };
    PaintOp into_locked = in_group(3), held = in_group(0), raising = in_group(3);
    PaintOp filling = in_group(2), speckling = in_group(2);
    filling.brush = Brush::fill;
    speckling.brush = Brush::speckle;
    into_locked.locked.set(3);
    held.only_unpainted = true;
    raising.density = DensityBrush{40.0};
    PaintOp raising_locked = raising, raising_alone = raising, lowering = raising, resetting = raising,
            erasing = raising;
    raising_locked.locked.set(3);
    raising_alone.paints_group = false;
    lowering.density->offset = -25.0;
    resetting.density->offset = 0.0;
    erasing.group = 0;
    const std::vector<Case> cases = {
        {{.stroke = in_group(2), .regrouped = 144}, "Painted 144 voxels in group 2"},
        {{.stroke = in_group(4), .regrouped = 1}, "Painted 1 voxel in group 4"},
        {{.stroke = in_group(3), .regrouped = 144, .taken_from = {{1, 144}}},
         "Painted 144 voxels in group 3 (leaf trace), all taken from group 1 (aorta)"},
        {{.stroke = in_group(3), .regrouped = 1, .taken_from = {{1, 1}}},
         "Painted 1 voxel in group 3 (leaf trace), taken from group 1 (aorta)"},
        {{.stroke = in_group(3), .regrouped = 144, .taken_from = {{1, 44}, {2, 100}}},
         "Painted 144 voxels in group 3 (leaf trace), all taken from others: 100 from group 2 and 44 from group 1 "
         "(aorta)"},
        {{.stroke = in_group(5), .regrouped = 20, .taken_from = {{1, 12}}, .kept_locked = {{2, 40}}},
         "Painted 20 voxels in group 5; 12 of them were group 1 (aorta); 40 voxels of group 2 are locked and stayed"},
        {{.stroke = in_group(5), .regrouped = 20, .taken_from = {{1, 1}, {7, 2}, {8, 3}}},
         "Painted 20 voxels in group 5; 3 of them were group 8, 2 group 7 and 1 group 1 (aorta)"},
        {{.stroke = in_group(9), .regrouped = 90, .taken_from = {{1, 1}, {2, 2}, {3, 30}, {4, 4}, {5, 50}}},
         "Painted 90 voxels in group 9; 50 of them were group 5, 30 group 3 (leaf trace), 4 group 4 and 3 in 2 other "
         "groups"},
        {{.stroke = in_group(2), .regrouped = 5, .kept_locked = {{1, 1}}},
         "Painted 5 voxels in group 2; 1 voxel of group 1 (aorta) is locked and stayed"},
        {{.stroke = in_group(2), .regrouped = 5, .kept_locked = {{1, 9}, {3, 9}}, .kept_painted = 1},
         "Painted 5 voxels in group 2; 9 voxels of group 1 (aorta) and 9 of group 3 (leaf trace) are locked and "
         "stayed; "
         "1 voxel is painted already and stayed"},
        {{.stroke = in_group(2), .regrouped = 5, .kept_painted = 8},
         "Painted 5 voxels in group 2; 8 voxels are painted already and stayed"},
        {{.stroke = in_group(0), .regrouped = 144, .taken_from = {{1, 144}}}, "Erased 144 voxels of group 1 (aorta)"},
        {{.stroke = in_group(0), .regrouped = 144, .taken_from = {{1, 44}, {2, 100}}, .kept_locked = {{3, 2}}},
         "Erased 144 voxels: 100 of group 2 and 44 of group 1 (aorta); 2 voxels of group 3 (leaf trace) are locked and "
         "stayed"},
        {{.stroke = filling},
         "The stroke changed nothing: no voxel here is at or above the paint threshold, or all are painted already"},
        {{.stroke = in_group(0)},
         "The stroke changed nothing: the voxel at the centre of the probe is below the paint threshold, or all are "
         "unpainted already"},
        {{.stroke = raising_alone},
         "The stroke changed nothing: the voxel at the centre of the probe is below the paint threshold, or all are "
         "raised already"},
        {{.stroke = speckling},
         "The stroke changed nothing: no part at or above the paint threshold lies wholly inside the probe (a larger "
         "probe holds larger parts), or all are painted already"},
        {{.stroke = in_group(2), .kept_locked = {{1, 7}}},
         "Nothing was painted; 7 voxels of group 1 (aorta) are locked and stayed"},
        {{.stroke = in_group(0), .kept_locked = {{1, 7}}},
         "Nothing was erased; 7 voxels of group 1 (aorta) are locked and stayed"},
        {{.stroke = in_group(2), .kept_painted = 7}, "Nothing was painted; 7 voxels are painted already and stayed"},
        {{.stroke = into_locked, .kept_locked_out = 30},
         "Nothing was painted: group 3 (leaf trace) is locked; unlock it to paint in it"},
        {{.stroke = into_locked}, "Nothing was painted: group 3 (leaf trace) is locked; unlock it to paint in it"},
        {{.stroke = held, .kept_painted = 3}, "Nothing was erased: the brush is held to unpainted voxels"},
        {{.stroke = raising, .regrouped = 20, .raised = 30, .taken_from = {{1, 20}}},
         "Painted 20 voxels in group 3 (leaf trace), all taken from group 1 (aorta); changed the density of 30 voxels "
         "(+40)"},
        {{.stroke = raising_alone, .raised = 1}, "Changed the density of 1 voxel (+40)"},
        {{.stroke = lowering, .raised = 2}, "Changed the density of 2 voxels (-25)"},
        {{.stroke = resetting, .raised = 2}, "Reset the density of 2 voxels"},
        {{.stroke = erasing, .regrouped = 2, .raised = 2, .taken_from = {{2, 2}}},
         "Erased 2 voxels of group 2; reset the density of 2 voxels"},
        {{.stroke = raising_locked, .raised = 2, .kept_locked_out = 2},
         "Changed the density of 2 voxels (+40); group 3 (leaf trace) is locked, so no voxel was painted"},
        {{.stroke = raising, .raised = 2, .kept_locked = {{2, 2}}},
         "Changed the density of 2 voxels (+40); 2 voxels of group 2 are locked and stayed"},
    };
    for (const Case& c : cases) CHECK(sentence_of(c.result, known_name) == c.words);
}
