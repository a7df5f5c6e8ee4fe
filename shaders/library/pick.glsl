// The point of a ray at which the user points: where the ray's opacity rises most.

// Result of PICK: the run of samples that adds most to the ray's opacity, and the run's sample that adds most.
struct Rises {
    float most, most_at;               // the best run so far; members that end in `_at` are lengths along the ray
    float run, steepest, steepest_at;  // of the present run
    float peak, trough;                // largest opacity of a sample of this run, and the smallest after that
};

// A run ends when the samples' opacity has fallen well below the run's peak and rises again, because another structure
// begins there. Slight noise does not end a run.
void note_rise(inout Rises rises, float added, float opacity, float at)
{
    const bool begins = rises.trough < 0.25 * rises.peak && opacity > 2.0 * rises.trough;
    rises.run = begins ? 0.0 : rises.run;
    rises.steepest = begins ? 0.0 : rises.steepest;
    rises.peak = begins ? opacity : rises.peak;
    rises.trough = opacity >= rises.peak ? opacity : min(rises.trough, opacity);
    rises.peak = max(rises.peak, opacity);
    rises.run += added;
    const bool is_steeper = added > rises.steepest;
    rises.steepest = is_steeper ? added : rises.steepest;
    rises.steepest_at = is_steeper ? at : rises.steepest_at;
    const bool is_most = rises.run > rises.most;
    rises.most = is_most ? rises.run : rises.most;
    rises.most_at = is_most ? rises.steepest_at : rises.most_at;
}
