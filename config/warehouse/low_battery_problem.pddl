; left corridor -- central corridor -- right corridor
;                          |           /
;                   warehouses' doors
;                     /           \
;               red warehouse   blue warehouse
(define (problem fetch-with-a-low-battery)
  (:domain warehouse)
  (:objects
    left center right doors red_room blue_room - place
    red_circle red_triangle red_cube blue_cube blue_circle - item
    top_left_door top_right_door bottom_door - door)
  (:init
    (robot-at left)
    (connected left center) (connected center left)
    (connected center right) (connected right center)
    (connected center doors) (connected doors center)
    (connected right doors) (connected doors right)
    (connected doors red_room) (connected red_room doors)
    (connected doors blue_room) (connected blue_room doors)
    (item-at red_circle red_room) (item-at red_triangle red_room) (item-at red_cube red_room)
    (item-at blue_cube blue_room) (item-at blue_circle blue_room)
    (door-at top_left_door left) (door-at top_right_door right) (door-at bottom_door right)
    (station-at center))
  (:goal (and (holding red_circle) (holding blue_cube) (outside bottom_door))))
