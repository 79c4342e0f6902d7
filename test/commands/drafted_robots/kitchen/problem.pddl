(define (problem lunch) (:domain kitchen)
  (:objects omelette pancake - hot-dish salad fruit_bowl - cold-dish
    eggs herbs flour lettuce tomatoes apples grapes milk - ingredient
    fridge pantry - store window_table corner_table terrace - table)
  (:init (gas-on) (pan-clean) (counter-wiped)
    (kept eggs fridge) (kept milk fridge) (kept lettuce fridge) (kept grapes fridge)
    (kept herbs pantry) (kept flour pantry) (kept tomatoes pantry) (kept apples pantry)
    (recipe omelette eggs herbs) (recipe pancake flour milk)
    (recipe salad lettuce tomatoes) (recipe fruit_bowl apples grapes))
  (:goal (and (served omelette window_table) (served salad terrace) (counter-wiped))))
