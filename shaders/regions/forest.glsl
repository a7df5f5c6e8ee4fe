// The union-find forest of runs. Needs `bits` (words) and `parents` (a uint per bit, used at first bits of runs).

// Returns the first bit of the run in `word` that contains `bit`.
uint run_start(uint word, uint bit)
{
    const uint gaps = ~word & ((1u << bit) - 1u);   // clear bits below
    return gaps == 0u ? 0u : uint(findMSB(gaps)) + 1u;
}

uint find_root(uint run)
{
    uint parent = parents.of[run];
    while (parent != run) {
        run = parent;   // same again: a root is its own parent
        parent = parents.of[run];
    }
    return run;
}
