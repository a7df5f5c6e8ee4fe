#include "engine/study/report/thesis_table.h"

namespace shvr {

namespace {

constexpr int TRUE_SEGMENTS = 26;
constexpr ThesisRow ROWS[] = {
    {0, 1.000, .824, .971, 0, 70, 1.000, 0, 71, 26, 0}, {2, .883, .770, .969, 0, 32, .914, 2, 29, 11, 0},
    {3, .862, .819, .916, 3, 63, .967, 1, 63, 26, 0},   {5, .907, .841, .938, 3, 57, 1.000, 0, 54, 17, 0},
    {6, .966, .841, .974, 1, 73, 1.000, 0, 72, 23, 0},  {7, .988, .814, .977, 0, 46, .995, 0, 46, 14, 0},
    {8, .991, .817, .959, 1, 43, .987, 0, 38, 11, 0},   {9, .970, .803, .918, 2, 46, .968, 2, 48, 26, 1},
    {10, .881, .847, .977, 0, 53, .941, 3, 47, 19, 4},  {11, .975, .806, .964, 0, 35, .966, 1, 35, 14, 1},
    {12, .986, .812, .871, 7, 67, .909, 6, 63, 24, 1}};

}  // namespace

std::optional<double> ThesisRow::value(Outcome outcome) const
{
    switch (outcome) {
        case Outcome::dice_partial: return dice_partial;
        case Outcome::dice_full: return dice_full;
        case Outcome::node_score: return node_score;
        case Outcome::nodes_out: return nodes_out;
        case Outcome::nodes: return nodes;
        case Outcome::internode_score: return internode_score;
        case Outcome::internodes_out: return internodes_out;
        case Outcome::internodes: return internodes;
        case Outcome::segments_found: return segments_found;
        case Outcome::segments_total: return TRUE_SEGMENTS;
        case Outcome::topological_errors: return topological_errors;
        default: return std::nullopt;
    }
}

std::span<const ThesisRow> thesis_rows()
{
    return ROWS;
}

}  // namespace shvr
