#version 460
#extension GL_EXT_buffer_reference : require
#extension GL_GOOGLE_include_directive : require
// Adds the light of every shadow ray that met nothing; with BLEND, what came through.

#include "render/shared/queue.glsl"

layout(local_size_x_id = 0, local_size_x = 64) in;
layout(constant_id = 1) const bool BLEND = false; // the answer is the share of the light that comes through

layout(push_constant, std430) uniform LightAdd {
    QueueIn queue;
    PathsIn paths;
    WordsIn occluded; // 0, 1, or given up; with BLEND the bits of a float, or given up
    FilmInOut film;
    WordsInOut unfinished;
};

void main() {
    uint i = invocation_index();
    if (i >= queue.header.count) {
        return;
    }
    Path path = paths.path[i];
    uint answer = occluded.word[i];
    if (answer == GRIDWALK_UNFINISHED) {
        unfinished.word[path.slot] += 1u;
    } else if (BLEND) {
        film.film[path.slot].radiance += path.weight * uintBitsToFloat(answer);
    } else if (answer == 0u) {
        film.film[path.slot].radiance += path.weight;
    }
}
