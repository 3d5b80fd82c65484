; BROKEN     Twin of 04d_changing_direction.smt2: the guard takes the shorter of the two times.
(set-info :status sat)
(set-logic QF_NRA)

; Symbols
(declare-const b Real)        ; least braking, told to rest
(declare-const eps Real)      ; reaction time
(declare-const V Real)        ; greatest speed of the thing's class
(declare-const ka Real)       ; closing cosine of the one direction
(declare-const kb Real)       ; closing cosine of the other
(declare-const sa Real)       ; way in the one direction since seen
(declare-const sb Real)       ; way in the other
(declare-const age Real)      ; time since the thing was seen
(declare-const d Real)        ; clearance when the thing was seen
(declare-const wa Real)       ; greatest speed in the one
(declare-const wb Real)       ; greatest speed in the other
(declare-const te Real)       ; when the command to rest takes effect
(declare-const xa Real)       ; way in the one until te
(declare-const xb Real)       ; way in the other until te
(declare-const ve Real)       ; speed then
(declare-const tb Real)       ; time spent braking
(declare-const xbrake Real)   ; way while braking
(declare-const other Bool)    ; the robot goes the other way when it begins to brake
; Formulas
(define-fun way_to_rest ((w Real)) Real (+ (* w eps) (/ (* w w) (* 2 b))))
(define-fun time_to_rest ((w Real)) Real (+ eps (/ w b)))
(define-fun longer ((t Real) (u Real)) Real (ite (>= t u) u t)) ; BROKEN: the shorter

; Assumptions
(assert (> b 0))
(assert (> eps 0))
(assert (>= V 0))
(assert (>= ka 0))
(assert (>= kb 0))
(assert (>= sa 0))
(assert (>= sb 0))
(assert (>= age 0))
(assert (>= wa 0))
(assert (>= wb 0))
(assert (>= te 0))
(assert (>= xa 0))
(assert (>= xb 0))
(assert (>= ve 0))
(assert (>= tb 0))
(assert (>= xbrake 0))
(assert (and (<= ka 1) (<= kb 1)))
(assert (<= (+ (* ka (+ sa (way_to_rest wa))) (* kb (+ sb (way_to_rest wb)))
               (* V (+ age (longer (time_to_rest wa) (time_to_rest wb))))) d))
(assert (<= te eps))
(assert (<= xa (* wa te)))
(assert (<= xb (* wb te)))
(assert (<= ve (ite other wb wa)))
(assert (<= (* b tb) ve))
(assert (<= (* 2 b xbrake) (* ve ve)))

; Conclusion, negated
(assert (not (>= (- d (* ka (+ sa xa (ite other 0 xbrake))) (* kb (+ sb xb (ite other xbrake 0)))
                    (* V (+ age te tb))) 0)))
(check-sat)
