/* feature.c - records which features a scene file uses and how they are supported. A statement counts as
 * approximated if something was noted about it or the table says so, and as ignored if its handler says
 * so. */
#include "pbrt/state.h"

#include <stdio.h>
#include <string.h>

static const struct kind {
    const char *directive, *name;
    bool by_directive;  /* the feature has the directive's name, else that of the class */
    const char *remark; /* how it is always approximated, or NULL */
} kinds[] = {
    { "Shape", "shape", false, NULL },
    { "LightSource", "light", false, NULL },
    { "AreaLightSource", "area light", false, NULL },
    { "Material", "material", false, NULL },
    { "MakeNamedMaterial", "material", false, NULL },
    { "Texture", "texture", false, NULL },
    { "ObjectInstance", "directive", true, NULL },
    { "MediumInterface", "medium", true, NULL },
    { "MakeNamedMedium", "medium", true, NULL },
    { "Volume", "medium", true, NULL },
    { "VolumeIntegrator", "medium", true, "light is scattered once, by points along each ray" },
    { "Film", "film", false, NULL },
    { "Camera", "camera", false, NULL },
    { "PixelFilter", "filter", false, NULL },
    { "Sampler", "sampler", false, "the number of samples counts; their places are our own" },
    { "Integrator", "integrator", false, "maxdepth counts; light is gathered by lightcuts" },
    { "SurfaceIntegrator", "integrator", false, "maxdepth counts; light is gathered by lightcuts" },
    { "Renderer", "directive", true, "light is gathered by lightcuts" },
    { "Option", "directive", true, "options of pbrt itself" },
    { "ColorSpace", "directive", true, NULL },
    { "Attribute", "directive", true, NULL },
    { "ActiveTransform", "directive", true, NULL },
    { "LightGroup", "directive", true, NULL },
    { "TransformTimes", "directive", true, "what moves stands still" },
};

lc_status lc_pbrt_count_feature(lc_pbrt *p, const char *directive, uint64_t n_noted)
{
    lc_scene *scene = p->scene;
    char name[96];
    size_t i = 0, n = sizeof kinds / sizeof *kinds;
    while (i < n && strcmp(kinds[i].directive, directive)) i++;
    if (i == n) return LC_OK;
    bool noted = scene->n_noted > n_noted;
    lc_support support = p->ignored                 ? LC_SUPPORT_IGNORED
                         : noted || kinds[i].remark ? LC_SUPPORT_APPROXIMATED
                                                    : LC_SUPPORT_YES;
    bool full = scene->n_features >= LC_PBRT_MAX_KINDS;
    snprintf(name, sizeof name, "%.90s", full ? "other" : kinds[i].by_directive ? directive : p->owner);
    lc_pbrt_printable(name);
    return lc_scene_count_feature(scene, kinds[i].name, name, support,
                                  noted ? scene->noted : kinds[i].remark);
}
