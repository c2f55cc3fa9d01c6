/* view_grid.c - makes the grid and scores single lights by it. */
#include "prepare/view_grid.h"

#include "base/rng.h"
#include "scene/view.h"
#include "shade/lobe.h"
#include "shade/point_init.h"
#include "trace/bvh.h"

#include <string.h>

static const lc_material grey = { .kd = { 0.5f, 0.5f, 0.5f } };

static void add_view(lc_view_grid *view, const lc_camera *camera, uint32_t side, uint32_t max_depth)
{
    const lc_scene *scene = view->scene;
    const double lens[2] = { 0.5, 0.5 };
    const lc_sight_desc how = {
        .pixel = camera->pixel, .max_depth = max_depth, .n_points = 1, .offset = 0.5
    };
    const double width = scene->film.width, height = scene->film.height;
    for (uint32_t i = 0; i < side * side; i++) {
        lc_f3 dir;
        lc_sight sight;
        if (!lc_view_sight_by(scene, camera, (i % side + 0.5) / side * width,
                              (i / side + 0.5) / side * height, lens, &how, &dir, &sight) ||
            !sight.n_lit)
            continue;
        const lc_lit *lit = &sight.lit[0];
        lc_point_init(&view->points[view->n], lit->surface.pos, lit->surface.n, lit->view, &grey, LC_MIN_D2);
        view->lobe[view->n] = lc_lobe_angle(&lit->surface.material);
        memcpy(view->org[view->n++], lit->surface.ray_org, sizeof view->org[0]);
    }
}

lc_status lc_view_grid_init(lc_view_grid *view, const lc_scene *scene, uint32_t side, uint32_t max_depth)
{
    const uint32_t n_views = lc_view_count(scene), each = lc_view_side(scene, side);
    const size_t room = (size_t)each * each * n_views;
    *view = (lc_view_grid){ .scene = scene, .room = room };
    view->points = lc_alloc_raw(scene->ctx, room, sizeof *view->points);
    view->org = lc_alloc_raw(scene->ctx, room, sizeof *view->org);
    view->lobe = lc_alloc_raw(scene->ctx, room, sizeof *view->lobe);
    if (!view->points || !view->org || !view->lobe) return LC_ERR_MEMORY;
    for (uint32_t i = 0; i < n_views; i++) add_view(view, lc_view_camera(scene, i), each, max_depth);
    return LC_OK;
}

float lc_lobe_angle(const lc_material *m)
{
    if (!(lc_f3_max(m->ks) > 0) || m->mirror || m->glass || !lc_lobe_is_narrow(m->lobe)) return 4;
    return m->lobe == LC_LOBE_PHONG ? 1 / sqrtf(m->exponent + 2) : fminf(m->roughness[0], m->roughness[1]);
}

void lc_view_grid_free(lc_view_grid *view)
{
    const size_t n = view->room;
    if (!n) return;
    lc_free(view->scene->ctx, view->points, n, sizeof *view->points);
    lc_free(view->scene->ctx, view->org, n, sizeof *view->org);
    lc_free(view->scene->ctx, view->lobe, n, sizeof *view->lobe);
    *view = (lc_view_grid){ 0 };
}

float lc_unoccluded_luminance(const lc_shade_kernels *kernels, const lc_point *p, const lc_light *light,
                              const lc_light_rec *rec)
{
    return lc_luminance(lc_f3_mul(lc_estimate_one(kernels, p, light->kind, rec, NULL), light->intensity));
}

/* Shadow rays are traced from the light to the points, so that all have the same origin. */
double lc_view_grid_importance(const lc_view_grid *view, const lc_light *light, uint64_t hash)
{
    const lc_bvh *bvh = view->scene->bvh;
    const lc_shade_kernels *kernels = view->scene->ctx->shade_kernels;
    const float org[3] = { light->pos.x, light->pos.y, light->pos.z };
    float to[3][LC_IMPORTANCE_POINTS], f[LC_IMPORTANCE_POINTS];
    const float *const target[3] = { to[0], to[1], to[2] };
    uint8_t hidden[LC_IMPORTANCE_POINTS];
    uint32_t n = 0;
    double sum = 0;
    lc_light_rec rec;
    lc_light_rec_init(&rec, light);
    for (uint32_t k = 0; k < LC_IMPORTANCE_POINTS && view->n; k++) {
        /* Stratify over the picture. */
        uint32_t from = view->n * k / LC_IMPORTANCE_POINTS, end = view->n * (k + 1) / LC_IMPORTANCE_POINTS;
        uint32_t i = from + (uint32_t)(lc_hash2(hash, k) % (end > from ? end - from : 1));
        f[n] = lc_unoccluded_luminance(kernels, &view->points[i], light, &rec);
        if (!(f[n] > 0)) continue;
        for (int c = 0; c < 3; c++) to[c][n] = view->org[i][c];
        n++;
    }
    if (n) bvh->kernels->hidden(&bvh->data, org, n, target, false, hidden, NULL);
    for (uint32_t k = 0; k < n; k++) sum += hidden[k] ? 0 : (double)f[k];
    return sum / LC_IMPORTANCE_POINTS;
}
