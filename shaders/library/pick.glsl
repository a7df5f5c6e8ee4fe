// The point of a ray that the user points at: where its opacity rises most.

// Result of PICK: the run of samples that adds most to the ray's opacity, and the sample in it that adds most.
struct Rises {
    float most, most_at;               // the best run so far; members ending in `_at` are lengths along the ray
    float run, steepest, steepest_at;  // of the present run
    float peak, trough;                // largest opacity of a sample of this run, and the smallest one after it
};

// A run ends when the opacity of samples has fallen well below its peak and rises again: another structure begins.
// Slight noise does not end a run.
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
